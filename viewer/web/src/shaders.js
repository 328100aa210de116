// The look of the body: soft studio light fixed to the camera, so that the colors of a field stay readable
// from every side, with mesh edges drawn by the fragment shader.

// The position is interpolated at the covered part of a pixel (centroid): taken at its middle it would lie
// outside of triangles seen edge-on, and the cut would leave specks along the outline.
export const bodyVertex = /* glsl */ `
attribute float value;
attribute float valid;
attribute vec3 corner;
attribute vec3 solid;
centroid varying vec3 vWorld;
varying vec3 vEye;
varying vec3 vNormal;
varying vec3 vCorner;
varying vec3 vSolid;
varying float vValue;
varying float vValid;
void main() {
  vWorld = position;
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vEye = eye.xyz;
  vNormal = normalMatrix * normal;
  vCorner = corner;
  vSolid = solid;
  vValue = value;
  vValid = valid;
  gl_Position = projectionMatrix * eye;
}`;

export const bodyFragment = /* glsl */ `
uniform sampler2D table;
uniform vec2 range;      // values at the ends of the color table
uniform float mode;      // 0 field, 1 solid color of the part
uniform vec4 cut;        // kept where dot(cut.xyz, p) + cut.w <= 0
uniform float edges;     // strength of mesh edges
uniform vec3 upEye;      // world up in camera space
uniform float pixel;     // device pixels a CSS pixel
centroid varying vec3 vWorld;
varying vec3 vEye;
varying vec3 vNormal;
varying vec3 vCorner;
varying vec3 vSolid;
varying float vValue;
varying float vValid;

vec3 toLinear(vec3 c) { return pow(c, vec3(2.2)); }
vec3 toDisplay(vec3 c) { return pow(max(c, 0.0), vec3(1.0 / 2.2)); }

void main() {
  if (dot(cut.xyz, vWorld) + cut.w > 0.0) discard;
  vec3 base = vSolid;
  if (mode < 0.5) {
    float s = (vValue - range.x) / max(range.y - range.x, 1e-30);
    base = texture2D(table, vec2(clamp(s, 0.0, 1.0) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
    if (vValid < 0.999) base = vec3(0.56);
    if (vValid < -0.5) base = vSolid;  // an obstacle
  }
  base = toLinear(base);

  vec3 n = normalize(vNormal);
  vec3 v = normalize(-vEye);
  if (dot(n, v) < 0.0) n = -n;
  vec3 key = normalize(vec3(-0.45, 0.75, 0.65));
  vec3 fill = normalize(vec3(0.8, 0.05, 0.5));
  float sky = 0.5 + 0.5 * dot(n, upEye);
  float lit = 0.40 * mix(0.62, 1.12, sky)
            + 0.52 * max(dot(n, key), 0.0)
            + 0.22 * max(dot(n, fill), 0.0)
            + 0.20 * max(dot(n, v), 0.0);
  vec3 color = base * lit;
  vec3 h = normalize(key + v);
  color += 0.085 * pow(max(dot(n, h), 0.0), 42.0);
  // A darker rim separates overlapping folds of the same color.
  float rim = pow(1.0 - max(dot(n, v), 0.0), 3.5);
  color *= 1.0 - 0.30 * rim;

  if (edges > 0.0) {
    vec3 w = fwidth(vCorner);
    vec3 d = smoothstep(vec3(0.25), vec3(1.15), vCorner / max(w * pixel, 1e-6));
    float line = 1.0 - min(d.x, min(d.y, d.z));
    // Triangles of few pixels would turn the picture black: fade their edges out.
    line *= 1.0 - smoothstep(0.12, 0.4, max(w.x, max(w.y, w.z)) * pixel);
    color = mix(color, color * 0.22, edges * line);
  }
  gl_FragColor = vec4(toDisplay(color), 1.0);
}`;

/** Marks inside and outside behind the cut plane; writes no color. */
export const stencilFragment = /* glsl */ `
uniform vec4 cut;
centroid varying vec3 vWorld;
void main() {
  if (dot(cut.xyz, vWorld) + cut.w > 0.0) discard;
  gl_FragColor = vec4(0.0);
}`;

export const plainVertex = /* glsl */ `
centroid varying vec3 vWorld;
void main() {
  vWorld = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

/** Section filled by the stencil: where the run gave no values inside, hatching says "material". */
export const capFragment = /* glsl */ `
uniform vec3 color;
uniform float pixel;
void main() {
  float period = 7.0 * pixel;
  float s = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / period) - 0.5) * period;
  float line = 1.0 - smoothstep(0.45 * pixel, 1.15 * pixel, s);
  gl_FragColor = vec4(mix(color, color * 0.72, line), 1.0);
}`;

export const ghostVertex = /* glsl */ `
varying vec3 vEye;
varying vec3 vNormal;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vEye = eye.xyz;
  vNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * eye;
}`;

/** The rest shape as a veil: dense at its outline, clear where one looks through it. */
export const ghostFragment = /* glsl */ `
uniform vec3 color;
varying vec3 vEye;
varying vec3 vNormal;
void main() {
  float facing = abs(dot(normalize(vNormal), normalize(-vEye)));
  gl_FragColor = vec4(color, 0.10 + 0.55 * pow(1.0 - facing, 2.5));
}`;

export const dotVertex = /* glsl */ `
uniform float size;
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size;
}`;

export const dotFragment = /* glsl */ `
uniform vec3 color;
uniform vec3 ring;
uniform float opacity;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  float w = fwidth(r);
  float alpha = 1.0 - smoothstep(1.0 - w, 1.0, r);
  gl_FragColor = vec4(mix(color, ring, smoothstep(0.62 - w, 0.62, r)), alpha * opacity);
}`;
