// @ts-check
/** The shaders of the rolling pair; what a software renderer draws most of has the least to compute. */

export const BENT = "#define BENT\n";
export const MOVED = "#define MOVED\n";

/** Every tooth of a gear from one: turned to its place, twisted along the face, bent by what its pair carries; lit. */
export const TOOTH = `
in vec3 place;
in vec3 normal;
in float mark;
uniform mat4 view;
uniform vec4 turning; // angle of tooth 0, pitch (signed), position, number of teeth
uniform vec4 center; // x, y, mid-face, twist in rad per mm
uniform vec4 contact; // roll length at the pitch point, its sense, base pitch, tan(beta_b)
uniform vec4 table; // first place, step, both ends of the face
uniform vec4 bend; // mm per um with sign, rotation of the whole, root radius, base radius
uniform sampler2D passage; // pressure, how far apart
uniform vec2 ends; // of the roll length that meets
uniform vec3 back; // towards the eye
out float lit;
out float roll;
out float along;
flat out float pair; // place of the pair of this tooth
flat out int tooth;

#ifdef BENT
vec2 met(float at, float z) {
  vec2 size = vec2(textureSize(passage, 0));
  float row = (at - table.x) / table.y;
  if (row < 0.0 || row > size.y - 1.0) return vec2(0.0);
  float column = (z - table.z) / max(table.w - table.z, 1e-6) * (size.x - 1.0);
  return textureLod(passage, (vec2(clamp(column, 0.0, size.x - 1.0), row) + 0.5) / size, 0.0).xy;
}

#endif
#ifdef MOVED
uniform vec3 moved[66]; // displacement and rotation of each station
uniform vec3 stations; // first place, distance, whether all is one disc

vec3 shift(vec2 arm, float z) {
  float part = clamp((z - stations.x) / stations.y, 0.0, 31.9999);
  int k = 2 * int(part);
  vec3 rotation = mix(moved[k + 1], moved[k + 3], fract(part));
  return mix(moved[k], moved[k + 2], fract(part)) + cross(rotation, vec3(arm, stations.z * (z - stations.x)));
}

#endif
void main() {
  float index = float(gl_InstanceID);
  pair = mod(turning.z + index + 0.5 * turning.w, turning.w) - 0.5 * turning.w;
  tooth = gl_InstanceID;
  roll = mark;
  along = place.z;
  float angle = turning.x + turning.y * (turning.z + index) + center.w * (place.z - center.z) + bend.y;
#ifdef BENT
  float touching = clamp(contact.x + contact.y * (pair * contact.z - place.z * contact.w), ends.x, ends.y);
  float lever = sqrt(bend.w * bend.w + touching * touching) - bend.z;
  float part = clamp((length(place.xy) - bend.z) / lever, 0.0, 1.6);
  angle += 0.5 * bend.x * met(pair, place.z).y / bend.w * part;
#endif
  vec2 turned = vec2(cos(angle), sin(angle));
  mat2 rotation = mat2(turned.x, turned.y, -turned.y, turned.x);
  float slope = -center.w * dot(normal.xy, vec2(-place.y, place.x));
  vec3 facing = normalize(vec3(rotation * normal.xy, normal.z + slope));
  vec3 light = normalize(back + vec3(0.1, 0.6, 0.1));
  lit = 0.34 + 0.62 * max(dot(facing, light), 0.0) + 0.10 * pow(max(dot(facing, back), 0.0), 12.0);
  vec3 stands = vec3(rotation * place.xy + center.xy, place.z);
#ifdef MOVED
  stands += shift(rotation * place.xy, place.z);
#endif
  gl_Position = view * vec4(stands, 1.0);
}`;

/** Lit steel. */
export const STEEL = `
in float lit;
uniform vec4 color; // and opacity
out vec4 painted;
void main() {
  painted = vec4(color.rgb * lit * color.a, color.a);
}`;

const SCALE = `
vec3 scale(float part) { // cividis, as the maps of reports
  vec3 low = mix(vec3(0.0, 0.135, 0.305), vec3(0.34, 0.36, 0.43), clamp(2.5 * part, 0.0, 1.0));
  vec3 high = mix(low, vec3(0.73, 0.68, 0.45), clamp(2.5 * part - 1.0, 0.0, 1.0));
  return mix(high, vec3(1.0, 0.91, 0.27), clamp(5.0 * part - 4.0, 0.0, 1.0));
}
`;

/** The surface of a housing at a phase. */
export const HULL = `
in vec3 place;
in vec3 normal;
in float mark; // place of its level on the scale; below 0: it has none
in vec3 real;
in vec3 imaginary;
uniform mat4 view;
uniform vec2 now; // cosine and sine of the phase, as large as it is drawn
uniform vec3 back;
out float lit;
out float part;
void main() {
  vec3 light = normalize(back + vec3(0.1, 0.6, 0.1));
  lit = 0.4 + 0.6 * abs(dot(normal, light));
  part = mark;
  gl_Position = view * vec4(place + now.x * real - now.y * imaginary, 1.0);
}`;

export const LEVELS = `
in float lit;
in float part;
uniform float opacity;
out vec4 painted;
${SCALE}
void main() {
  vec3 own = part < 0.0 ? vec3(0.5, 0.55, 0.6) : scale(part);
  painted = vec4(own * lit * opacity, opacity);
}`;

const PASSAGE = `
in float lit;
in float roll;
in float along;
flat in float pair;
flat in int tooth;
uniform vec4 contact;
uniform vec4 color;
uniform vec2 ends;
out vec4 painted;
`;

/** Which tooth it is, and where on its flank. */
export const PICK = `${PASSAGE}
uniform vec2 face; // its ends
uniform float gear; // 1 or 2, 2 more on a flank that carries
void main() {
  float carries = roll > ends.x && roll < 1.002 * ends.y ? 1.0 : 0.0;
  vec2 part = clamp(vec2((roll - ends.x) / (ends.y - ends.x), (along - face.x) / (face.y - face.x)), 0.0, 1.0);
  painted = vec4((gear + 2.0 * carries + 8.0 * float(tooth / 256)) / 255.0, float(tooth % 256) / 255.0, part);
}`;

/** A flank that carries: the pressure it meets, and the contact line where it is now. */
export const FLANK = `${PASSAGE}
uniform vec4 table;
uniform vec2 shown; // largest pressure of the scale, half width of a contact line
uniform sampler2D passage;

float pressure(float at) {
  vec2 size = vec2(textureSize(passage, 0));
  float row = (at - table.x) / table.y;
  float width = size.x > 1.0 ? (table.w - table.z) / (size.x - 1.0) : 0.0;
  float column = (along - table.z) / max(table.w - table.z, 1e-6) * (size.x - 1.0);
  float within = step(0.0, row) * step(row, size.y - 1.0) * step(table.z - 0.5 * width, along) * step(along, table.w + 0.5 * width);
  return within * textureLod(passage, (vec2(clamp(column, 0.0, size.x - 1.0), row) + 0.5) / size, 0.0).x;
}

${SCALE}
void main() {
  float carries = step(ends.x, roll) * step(roll, 1.002 * ends.y);
  float met = carries * pressure((contact.y * (roll - contact.x) + along * contact.w) / contact.z);
  float now = carries * pressure(pair);
  float touching = clamp(contact.x + contact.y * (pair * contact.z - along * contact.w), ends.x, ends.y);
  float line = step(0.5, now) * smoothstep(1.0, 0.6, abs(roll - touching) / shown.y);
  vec3 own = mix(color.rgb * lit, scale(met / shown.x) * (0.5 + 0.5 * lit), 0.7 * step(0.5, met));
  own = mix(own, mix(vec3(0.80, 0.05, 0.15), vec3(1.0, 0.95, 0.75), now / shown.x), line);
  float opacity = mix(color.a, 1.0, line);
  painted = vec4(own * opacity, opacity);
}`;
