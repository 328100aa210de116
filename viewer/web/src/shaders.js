// The look of the body: soft studio light fixed to the camera, so that the colors of a field stay readable
// from every side, with mesh edges drawn by the fragment shader.
// FADED lets one look through.
//
// Each picture pays for what it shows: FIELD colors by value (otherwise by the solid color), INVALID paints
// values that are not finite gray, CUT takes one side of the plane away, EDGES draws the mesh. Without a
// graphics card every number that is carried from the corners of a triangle to its pixels costs time.

// The position is interpolated at the covered part of a pixel (centroid): taken at its middle it would lie
// outside of triangles seen edge-on, and the cut would leave specks along the outline.
export const bodyVertex = /* glsl */ `
attribute float shade;
varying vec3 vEye;
varying vec4 vNormal;  // and in w how much of the light is missing
#ifdef FIELD
attribute float value;
varying float vValue;
#else
attribute vec3 solid;
varying vec3 vSolid;
#endif
#ifdef INVALID
attribute float valid;
varying float vValid;
#endif
#ifdef CUT
centroid varying vec3 vWorld;
#endif
#ifdef EDGES
attribute vec3 corner;
varying vec3 vCorner;
#endif
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vEye = eye.xyz;
  vNormal = vec4(normalMatrix * normal, shade);
#ifdef FIELD
  vValue = value;
#else
  vSolid = solid;
#endif
#ifdef INVALID
  vValid = valid;
#endif
#ifdef CUT
  vWorld = position;
#endif
#ifdef EDGES
  vCorner = corner;
#endif
  gl_Position = projectionMatrix * eye;
}`;

export const bodyFragment = /* glsl */ `
uniform vec3 upEye;      // world up in camera space
varying vec3 vEye;
varying vec4 vNormal;
#ifdef FIELD
uniform sampler2D table;
uniform vec2 range;      // values at the ends of the color table
varying float vValue;
#else
varying vec3 vSolid;
#endif
#ifdef INVALID
varying float vValid;
#endif
#ifdef CUT
uniform vec4 cut;        // kept where dot(cut.xyz, p) + cut.w <= 0
centroid varying vec3 vWorld;
#endif
#ifdef EDGES
uniform float edges;     // strength of mesh edges
uniform float pixel;     // device pixels a CSS pixel
varying vec3 vCorner;
#endif

void main() {
#ifdef CUT
  if (dot(cut.xyz, vWorld) + cut.w > 0.0) discard;
#endif
#ifdef FIELD
  float s = (vValue - range.x) / max(range.y - range.x, 1e-30);
  vec3 base = texture2D(table, vec2(clamp(s, 0.0, 1.0) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
#else
  vec3 base = vSolid;
#endif
#ifdef INVALID
  if (vValid < 0.999) base = vec3(0.56);
#endif
  base *= base;  // light adds up where values are linear; 2 is near enough to the 2.2 of a display

  vec3 n = normalize(vNormal.xyz);
  vec3 v = normalize(-vEye);
  float facing = dot(n, v);
  if (facing < 0.0) { n = -n; facing = -facing; }
  const vec3 key = vec3(-0.4129, 0.6882, 0.5965);
  const vec3 fill = vec3(0.8468, 0.0529, 0.5293);
  float sky = 0.5 + 0.5 * dot(n, upEye);
  float lit = 0.40 * mix(0.62, 1.12, sky)
            + 0.52 * max(dot(n, key), 0.0)
            + 0.22 * max(dot(n, fill), 0.0)
            + 0.20 * facing;
  lit *= 1.0 - vNormal.w;
  vec3 color = base * lit;
  float h = max(dot(n, normalize(key + v)), 0.0);
  float h2 = h * h, h8 = h2 * h2 * h2 * h2, h32 = h8 * h8 * h8 * h8;
  color += 0.085 * h2 * h8 * h32 * (1.0 - vNormal.w);
  // A darker rim separates overlapping folds of the same color.
  float rim = 1.0 - facing;
  color *= 1.0 - 0.30 * rim * rim * rim * sqrt(rim);

#ifdef EDGES
  vec3 w = fwidth(vCorner);
  vec3 d = smoothstep(vec3(0.25), vec3(1.15), vCorner / max(w * pixel, 1e-6));
  float line = 1.0 - min(d.x, min(d.y, d.z));
  // Triangles of few pixels would turn the picture black: fade their edges out.
  line *= 1.0 - smoothstep(0.12, 0.4, max(w.x, max(w.y, w.z)) * pixel);
  color = mix(color, color * 0.22, edges * line);
#endif
#ifdef FADED
  gl_FragColor = vec4(sqrt(max(color, 0.0)), 0.16 + 0.45 * rim * rim);
#else
  gl_FragColor = vec4(sqrt(max(color, 0.0)), 1.0);
#endif
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

/** A picture as it is, pixel for pixel. */
export const copyVertex = /* glsl */ `
void main() {
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

export const copyFragment = /* glsl */ `
uniform sampler2D picture;
void main() {
  gl_FragColor = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}`;
