// Colours of layers, and colour maps: a few colours, interpolated. viridis, cividis and turbo after their public tables.

const hex = text => text.match(/[0-9a-f]{6}/g).map(c => [0, 2, 4].map(i => parseInt(c.slice(i, i + 2), 16)));

export const MAPS = {
    viridis: hex("440154 482475 414487 355f8d 2a788e 21918c 22a884 44bf70 7ad151 bddf26 fde725"),
    cividis: hex("00224e 123570 3b496c 575d6d 707173 8a8678 a59c74 c3b369 e1cc55 fee838"),
    turbo: hex("30123b 4145ab 4675ed 39a2fc 1bcfd4 24eca6 61fc6c a4fc3b d1e834 f3c63a fe9b2d f36315 d93806 b11901 7a0402"),
    "blue to red": hex("2166ac 4393c3 92c5de d1e5f0 f7f7f7 fddbc7 f4a582 d6604d b2182b"),
    grey: hex("101010 f0f0f0"),
};

export const LAYER_COLOURS = hex("c9ced6 e0a458 6fa8dc 93c47d c27ba0 76a5af ffd966 8e7cc3 e06666 a2c4c9 b6d7a8 d5a6bd");

/** Returns the colour at t from 0 to 1. */
export function colourAt(name, t) {
    const map = MAPS[name], x = Math.max(0, Math.min(1, t)) * (map.length - 1), i = Math.min(map.length - 2, Math.floor(x));
    return map[i].map((c, k) => Math.round(c + (x - i) * (map[i + 1][k] - c)));
}

/** Returns 256 colours as bytes of RGBA. */
export function paletteOf(name) {
    const bytes = new Uint8Array(1024);
    for (let i = 0; i < 256; i++) bytes.set([...colourAt(name, i / 255), 255], 4 * i);
    return bytes;
}
