// The programs of the graphics card. Places in attributes are whole numbers; uPlace takes them into the scene: xyz, and the
// length of a step. uCut.xyz . p > uCut.w is cut away.

const COMMON = `#version 300 es
precision highp float; precision highp int;
`;
const PLACED = `
uniform vec4 uPlace; uniform mat4 uMatrix; uniform mat4 uView; uniform vec4 uCut;
vec3 placed(vec3 q) { return q * uPlace.w + uPlace.xyz; }
`;
const COLOURED = `
uniform int uMode; uniform vec4 uColour; uniform vec2 uRange; uniform sampler2D uPalette;
vec4 coloured(vec4 rgba, float value) {
    if (uMode == 1) return vec4(rgba.rgb, 1.0);
    if (uMode == 2) {
        if (value > 1e30) return vec4(0.5, 0.5, 0.5, 1.0);
        float t = uRange.y > uRange.x ? (value - uRange.x) / (uRange.y - uRange.x) : 0.5;
        return texture(uPalette, vec2(clamp(t, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5));
    }
    return vec4(uColour.rgb, 1.0);
}
`;
const PICKED = `layout(location = 0) out uvec4 picked; uniform uint uLayer;`;
const DRAWN = `layout(location = 0) out vec4 drawn;`;

const vertex = body => `${COMMON}${PLACED}
layout(location = 0) in vec3 aPlace; layout(location = 1) in vec4 aNormal; layout(location = 2) in vec4 aRgba;
layout(location = 3) in float aValue;
out vec3 vPlace; out vec3 vEye; out vec3 vNormal; out vec4 vRgba; out float vValue; flat out uint vId;
uniform float uSize;
void main() {
    vPlace = placed(aPlace); vEye = (uView * vec4(vPlace, 1.0)).xyz;
    vNormal = mat3(uView) * aNormal.xyz; vRgba = aRgba; vValue = aValue; vId = uint(gl_VertexID);
    gl_Position = uMatrix * vec4(vPlace, 1.0);
    ${body}
}`;
const fragment = (outputs, body) => `${COMMON}${PLACED}${COLOURED}${outputs}
in vec3 vPlace; in vec3 vEye; in vec3 vNormal; in vec4 vRgba; in float vValue; flat in uint vId;
uniform bool uFlat; uniform bool uLit; uniform float uOpacity; uniform vec3 uBack;
void main() {
    if (dot(uCut.xyz, vPlace) > uCut.w) discard;
    ${body}
}`;
const PICK = "picked = uvec4(uLayer, vId, floatBitsToUint(gl_FragCoord.z), 1u);";

// Faces: two lights at the eye's side; the side that looks away from the eye has another colour.
const FACES = `
    vec3 flatNormal = normalize(cross(dFdx(vEye), dFdy(vEye)));
    vec3 n = uFlat || dot(vNormal, vNormal) < 0.01 ? flatNormal : normalize(gl_FrontFacing ? vNormal : -vNormal);
    if (n.z < 0.0 && uFlat) n = -n;
    vec4 colour = coloured(vRgba, vValue);
    if (!gl_FrontFacing && uBack.r >= 0.0) colour.rgb = uMode == 0 ? uBack : mix(colour.rgb, uBack, 0.35);
    float light = uLit ? 0.28 + 0.62 * max(0.0, dot(n, normalize(vec3(-0.35, 0.55, 0.8)))) + 0.22 * max(0.0, dot(n, normalize(vec3(0.7, -0.3, 0.5)))) : 1.0;
    drawn = vec4(colour.rgb * light, uOpacity);`;
const POINTS = `
    vec4 colour = coloured(vRgba, vValue);
    float light = uLit && dot(vNormal, vNormal) > 0.01 ? 0.35 + 0.65 * abs(normalize(vNormal).z) : 1.0;
    drawn = vec4(colour.rgb * light, uOpacity);`;
const ROUND = "vec2 c = gl_PointCoord - 0.5; if (dot(c, c) > 0.25) discard;";
const SIZED = "gl_PointSize = uSize;";
const NEARER = "gl_Position.z -= 2e-4 * gl_Position.w;"; // lines and marks on faces are in front of these

export const PROGRAMS = {
    faces: [vertex(""), fragment(DRAWN, FACES)],
    marks: [vertex(NEARER), fragment(DRAWN, FACES)],
    points: [vertex(SIZED), fragment(DRAWN, ROUND + POINTS)],
    lines: [vertex(NEARER), fragment(DRAWN, POINTS)],
    pickFaces: [vertex(""), fragment(PICKED, PICK)],
    pickPoints: [vertex(SIZED), fragment(PICKED, ROUND + PICK)],
    // Balls: a square for each, which looks at the eye, and in it the ball's side that does.
    balls: [`${COMMON}${PLACED}
layout(location = 0) in vec4 aBall; out vec3 vPlace; flat out vec4 vBall; out vec2 vCorner;
void main() {
    vCorner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vBall = vec4(placed(aBall.xyz), aBall.w * uPlace.w);
    vPlace = vBall.xyz + vBall.w * (transpose(mat3(uView)) * vec3(vCorner, 0.0));
    gl_Position = uMatrix * vec4(vPlace, 1.0);
}`, `${COMMON}${PLACED}
${DRAWN} in vec3 vPlace; flat in vec4 vBall; in vec2 vCorner; uniform vec4 uColour; uniform float uOpacity;
void main() {
    float rest = 1.0 - dot(vCorner, vCorner);
    if (rest < 0.0) discard;
    vec3 n = vec3(vCorner, sqrt(rest)), p = vBall.xyz + vBall.w * (transpose(mat3(uView)) * n);
    if (dot(uCut.xyz, p) > uCut.w) discard;
    vec4 clip = uMatrix * vec4(p, 1.0);
    gl_FragDepth = clip.z / clip.w * 0.5 + 0.5;
    float light = 0.28 + 0.62 * max(0.0, dot(n, normalize(vec3(-0.35, 0.55, 0.8)))) + 0.22 * max(0.0, dot(n, normalize(vec3(0.7, -0.3, 0.5))));
    drawn = vec4(uColour.rgb * light, uOpacity);
}`],
    // Shades by depth: of a pixel, by how far it is behind its eight neighbours, as parts of its own distance. uLens has two numbers of
    // the projection, whether that is parallel, and the camera's distance.
    depths: [`${COMMON}
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`, `${COMMON}${DRAWN}
uniform sampler2D uColours; uniform sampler2D uDepth; uniform ivec4 uBox; uniform vec4 uLens; uniform int uApart;
float far(ivec2 at) {
    float z = 2.0 * texelFetch(uDepth, clamp(at, uBox.xy, uBox.zw), 0).r - 1.0;
    return uLens.z > 0.5 ? (uLens.y - z) / uLens.x : uLens.y / (z + uLens.x);
}
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 colour = texelFetch(uColours, at, 0);
    float here = far(at), scale = uLens.z > 0.5 ? uLens.w : here, behind = 0.0;
    if (texelFetch(uDepth, at, 0).r < 1.0)
        for (int i = 0; i < 9; i++) behind += max(0.0, here - far(at + uApart * ivec2(i % 3 - 1, i / 3 - 1)));
    drawn = vec4(colour.rgb * (0.35 + 0.65 * exp(-20.0 * behind / scale)), 1.0);
}`],
    // Wide lines: two triangles for each pair of ends, as wide as uSize pixels.
    wide: [`${COMMON}${PLACED}
layout(location = 0) in vec3 aFrom; layout(location = 1) in vec3 aTo; uniform float uSize; uniform vec2 uPixels;
out vec3 vPlace; out vec3 vEye; out vec3 vNormal; out vec4 vRgba; out float vValue; flat out uint vId;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec3 from = placed(aFrom), to = placed(aTo);
    vec4 a = uMatrix * vec4(from, 1.0), b = uMatrix * vec4(to, 1.0);
    vec2 along = (b.xy / b.w - a.xy / a.w) * uPixels; float l = length(along);
    along = l > 1e-4 ? along / l : vec2(1.0, 0.0);
    vec2 side = vec2(-along.y, along.x) * (corner.y * 2.0 - 1.0) + along * (corner.x * 2.0 - 1.0) * 0.5;
    vPlace = mix(from, to, corner.x); vEye = vPlace; vNormal = vec3(0.0); vRgba = vec4(1.0); vValue = 0.0; vId = 0u;
    gl_Position = corner.x < 0.5 ? a : b;
    gl_Position.xy += side * uSize / uPixels * gl_Position.w;
    gl_Position.z -= 4e-4 * gl_Position.w;
}`, fragment(DRAWN, POINTS)],
};
