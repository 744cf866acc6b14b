// What the graphics card does for every pixel: which way it looks, what light comes from there,
// and how that is shown. Axes: +X right (east), +Y up, -Z ahead (north).

const VERTEX_SHADER = `#version 300 es
void main() {
  // One triangle that covers the picture.
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;

const float PI = 3.14159265358979;
const int LOOK = 0, WHOLE = 1, BALLS = 2;

uniform usampler2D u_map, u_diffuse, u_glossy;
uniform usampler2D u_map_2, u_diffuse_2, u_glossy_2;
uniform sampler2D u_palette;
uniform vec2 u_size;
uniform int u_mode;
uniform int u_samples;
uniform mat3 u_world_from_view;
uniform float u_yaw;
uniform float u_tangent;
uniform bool u_compare;
uniform float u_split;
uniform vec2 u_layer_gains;
uniform float u_exposure;
uniform float u_ball_exposure;
uniform bool u_false_color;
uniform vec3 u_stops;

out vec4 o_color;

// A pixel's radiance. Beyond a pole the map goes on upside down, half a turn away.
vec3 texel(usampler2D map, ivec2 at, ivec2 size) {
  if (at.y < 0) { at = ivec2(at.x + size.x / 2, -1 - at.y); }
  if (at.y >= size.y) { at = ivec2(at.x + size.x / 2, 2 * size.y - 1 - at.y); }
  at.x = (at.x + 2 * size.x) % size.x;
  return uintBitsToFloat(texelFetch(map, at, 0).rgb << 16u);
}

vec3 light(usampler2D map, vec3 direction) {
  ivec2 size = textureSize(map, 0);
  float azimuth = atan(direction.x, -direction.z);
  float elevation = atan(direction.y, length(direction.xz));
  vec2 place = vec2(azimuth / (2.0 * PI) + 0.5, 0.5 - elevation / PI) * vec2(size) - 0.5;
  ivec2 corner = ivec2(floor(place));
  vec2 weight = place - vec2(corner);
  vec3 above = mix(texel(map, corner, size), texel(map, corner + ivec2(1, 0), size), weight.x);
  vec3 below = mix(texel(map, corner + ivec2(0, 1), size),
                   texel(map, corner + ivec2(1, 1), size), weight.x);
  return mix(above, below, weight.y);
}

vec3 light_of(bool second, vec3 direction) {
  if (second) { return light(u_map_2, direction) * u_layer_gains.y; }
  return light(u_map, direction) * u_layer_gains.x;
}

// Three balls in a row, white, rough and mirror; radiance and coverage.
vec4 ball(vec2 at, bool second, vec2 cell) {
  int column = int(min(at.x / cell.x, 2.0));
  vec2 center = (floor(at / cell) + 0.5) * cell;
  vec2 p = (at - center) / (0.46 * min(cell.x, cell.y));
  float radius = dot(p, p);
  if (radius >= 1.0) { return vec4(0.0); }
  vec3 normal = vec3(p, sqrt(1.0 - radius));
  vec3 mirrored = u_world_from_view * (2.0 * normal.z * normal - vec3(0.0, 0.0, 1.0));
  normal = u_world_from_view * normal;
  vec3 seen;
  float gain = second ? u_layer_gains.y : u_layer_gains.x;
  if (column == 0) {
    seen = second ? light(u_diffuse_2, normal) : light(u_diffuse, normal);
    gain *= u_false_color ? 1.0 : u_ball_exposure / u_exposure;
  } else if (column == 1) {
    seen = second ? light(u_glossy_2, mirrored) : light(u_glossy, mirrored);
  } else {
    seen = second ? light(u_map_2, mirrored) : light(u_map, mirrored);
  }
  return vec4(seen * gain, 1.0);
}

vec4 scene(vec2 at) {
  if (u_mode == BALLS) {
    vec2 cell = u_size / vec2(3.0, u_compare ? 2.0 : 1.0);
    return ball(at, u_compare && at.y < 0.5 * u_size.y, cell);
  }
  bool second = u_compare && at.x < u_split * u_size.x;
  if (u_mode == WHOLE) {
    float azimuth = (at.x / u_size.x - 0.5) * 2.0 * PI + u_yaw;
    float elevation = (at.y / u_size.y - 0.5) * PI;
    float level = cos(elevation);
    vec3 direction = vec3(level * sin(azimuth), sin(elevation), -level * cos(azimuth));
    return vec4(light_of(second, direction), 1.0);
  }
  vec2 p = (2.0 * at - u_size) / min(u_size.x, u_size.y) * u_tangent;
  return vec4(light_of(second, u_world_from_view * normalize(vec3(p, -1.0))), 1.0);
}

// The sRGB curve, IEC 61966-2-1.
vec3 encode(vec3 linear) {
  vec3 v = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(v, vec3(1.0 / 2.4)) - 0.055, 12.92 * v, lessThanEqual(v, vec3(0.0031308)));
}

vec3 false_color(vec3 linear) {
  float luminance = dot(linear, vec3(0.2126, 0.7152, 0.0722));
  float stops = log2(max(luminance * u_stops.z, 1e-30));
  float share = clamp((stops - u_stops.x) / (u_stops.y - u_stops.x), 0.0, 1.0);
  return texture(u_palette, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
}

void main() {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < u_samples; i++) {
    for (int j = 0; j < u_samples; j++) {
      vec2 offset = (vec2(i, j) + 0.5) / float(u_samples) - 0.5;
      sum += scene(gl_FragCoord.xy + offset);
    }
  }
  float coverage = sum.a / float(u_samples * u_samples);
  vec3 mean = sum.rgb / max(sum.a, 1.0);
  o_color = vec4(u_false_color ? false_color(mean) : encode(mean * u_exposure), 1.0) * coverage;
}`;
