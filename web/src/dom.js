// Elements of the page. Texts of files become text nodes only.

export function make(name, properties = {}, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
        if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
        else if (key in element && !key.startsWith("aria")) element[key] = value;
        else element.setAttribute(key, value);
    }
    element.append(...children.filter(child => child !== null && child !== undefined));
    return element;
}
export const at = id => document.getElementById(id);

let number = 0;
/** A control with its words before it, or behind it for a box to tick. */
export function labelled(words, control) {
    control.id ||= `c${number++}`;
    const label = make("label", { htmlFor: control.id }, words);
    return make("div", { className: control.type === "checkbox" ? "tick" : "field" }, ...(control.type === "checkbox" ? [control, label] : [label, control]));
}

/** The shortest decimal that reads back as the same number; `single` for numbers of single precision. */
export function exactly(x, single = false) {
    if (!single || !Number.isFinite(x)) return String(x);
    for (let digits = 1; digits < 10; digits++) {
        const text = x.toPrecision(digits);
        if (Math.fround(+text) === x) return String(+text);
    }
    return String(x);
}
/** A number that was rounded to multiples of `step`, without the digits that say nothing; 0: exact. */
export function about(x, step) {
    if (!(step > 0) || !Number.isFinite(x)) return exactly(x);
    if (x === 0) return "0";
    const digits = 1 + Math.floor(Math.log10(Math.abs(x))) - Math.floor(Math.log10(step));
    return String(+x.toPrecision(Math.max(1, Math.min(17, digits))));
}
/** The value of a property p: exact, or as exact as the page has it. */
export function shown(p, x) {
    if (!("low" in p)) return exactly(x, p.type === "float32");
    return Number.isNaN(x) ? "no finite number" : about(x, 2 * ((p.high / 2 - p.low / 2) / 65534));
}
export const short = x => Number.isFinite(x) ? String(+x.toPrecision(6)) : "—";
export const count = x => x.toLocaleString("en");
