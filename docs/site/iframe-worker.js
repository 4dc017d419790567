// Search of the site is in a worker, and a page that is opened from a folder may start none. This stands in for it there: an empty
// iframe, in which a script element loads the worker's program. Nothing is asked for over a network (mkdocs.yml).
if (location.protocol === "file:")
    window.Worker = class extends EventTarget {
        constructor(address) {
            super();
            const frame = Object.assign(document.createElement("iframe"), { hidden: true });
            document.body.append(frame);
            this.inside = frame.contentWindow;
            this.inside.postMessage = data => this.dispatchEvent(new MessageEvent("message", { data }));
            const script = this.inside.document.createElement("script");
            this.loaded = new Promise((done, failed) => Object.assign(script, { src: address, onload: done, onerror: failed }));
            this.inside.document.body.append(script);
            this.frame = frame;
        }
        postMessage(data) {
            this.loaded.then(() => this.inside.dispatchEvent(new MessageEvent("message", { data })));
        }
        terminate() {
            this.frame.remove();
        }
    };
