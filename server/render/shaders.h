// SPDX-License-Identifier: MIT
// GLSL 3.30. Colours are given as displayed: the shaders square them before lighting and take the root
// afterwards, which approximates the screen's gamma curve. With SKIN a mesh has the colours of its material.
#pragma once

namespace coopdyn::shaders {

inline constexpr const char* kHeader = "#version 330 core\n";

inline constexpr const char* kLight = R"(
uniform vec3 sun;  // towards it, length 1
const vec3 kSunColor = vec3(0.80, 0.76, 0.68);
const vec3 kSkyLight = vec3(0.40, 0.44, 0.50);
const vec3 kGroundLight = vec3(0.27, 0.25, 0.24);
vec3 Ambient(float nz) { return mix(kGroundLight, kSkyLight, nz * 0.5 + 0.5); }
// Lamps: each gives power × colour × cosine / distance². LAMPS is their number: the loop is unrolled, which takes half
// of the time of one whose end is a uniform.
#if LAMPS > 0
uniform vec3 lamp_place[LAMPS];
uniform vec3 lamp_light[LAMPS];
#endif
vec3 Lamps(vec3 p, vec3 n) {
  vec3 sum = vec3(0.0);
#if LAMPS > 0
  for (int i = 0; i < LAMPS; ++i) {
    vec3 to = lamp_place[i] - p;
    float d2 = max(dot(to, to), 1e-4);
    sum += lamp_light[i] * max(dot(n, to), 0.0) / (d2 * sqrt(d2));
  }
#endif
  return sum;
}
)";

inline constexpr const char* kMeshVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 axis_x;
layout(location = 3) in vec3 axis_y;
layout(location = 4) in vec3 axis_z;
layout(location = 5) in vec3 scale;
layout(location = 6) in vec3 place;
layout(location = 7) in vec3 color;
#ifdef SKIN
layout(location = 8) in vec2 uv;
uniform vec3 tint;
out vec2 skin_uv;
#endif
#ifdef ROUND
uniform vec3 eye;
out vec3 own;  // place on the unit shape, and the way there from the eye
out vec3 own_ray;
#endif
#ifdef CLAD
out vec3 own_place;  // m, from the shape's middle
out vec3 own_normal;
#endif
uniform mat4 clip_from_world;
uniform vec3 shadow_along;  // the sun's direction with z = 1; zero: no shadow
out vec3 world;
out vec3 world_normal;
out vec3 base;
void main() {
  mat3 axes = mat3(axis_x, axis_y, axis_z);
  world = axes * (position * scale) + place;
  world_normal = axes * (normal / scale);
#ifdef SKIN
  base = tint * tint;
  skin_uv = vec2(uv.x, 1.0 - uv.y);
#else
  base = color * color;
#endif
#ifdef ROUND
  own = position;
  own_ray = position - transpose(axes) * (eye - place) / scale;
#endif
#ifdef CLAD
  own_place = position * scale;
  own_normal = normal;
#endif
  world -= shadow_along * max(world.z, 0.0);
  gl_Position = clip_from_world * vec4(world, 1.0);
}
)";

inline constexpr const char* kMeshFragment = R"(
in vec3 world;
in vec3 world_normal;
in vec3 base;
#ifdef SKIN
in vec2 skin_uv;
uniform sampler2D skin;
#endif
#ifdef CLAD
in vec3 own_place;
in vec3 own_normal;
uniform sampler2D skin;
uniform vec2 picture_size;  // m
#endif
uniform vec3 eye;
out vec4 result;
void main() {
  vec3 n = normalize(world_normal);
  vec3 v = normalize(eye - world);
  float lit = max(dot(n, sun), 0.0);
  float near_floor = mix(0.62, 1.0, smoothstep(0.0, 0.22, world.z));
  vec3 light = Ambient(n.z) * near_floor + kSunColor * lit + Lamps(world, n);
  float shine = pow(max(dot(n, normalize(v + sun)), 0.0), 36.0) * lit * 0.22;
  float rim = 1.0 - max(dot(n, v), 0.0);
  vec3 own = base;
#ifdef SKIN
  vec3 texel = texture(skin, skin_uv).rgb;
  own *= texel * texel;
#endif
#ifdef CLAD
  // One picture after the other from the middle of each side.
  vec3 a = abs(own_normal);
  vec2 side = a.z >= max(a.x, a.y) ? own_place.xy : a.x >= a.y ? own_place.yz : own_place.xz;
  vec2 at = side / picture_size + 0.5;
  vec3 texel = texture(skin, vec2(at.x, 1.0 - at.y)).rgb;
  own = texel * texel;
#endif
  result = vec4(sqrt(own * light + shine + 0.05 * rim * rim * rim), 1.0);
}
)";

inline constexpr const char* kShadowFragment = R"(
out vec4 result;
void main() { result = vec4(0.05, 0.06, 0.10, 0.30); }
)";

// Outputs the depth along the view and the instance's number, passed in red. Cylinders and spheres are drawn
// with flat sides but get the depth of the round surface: the distance from the flat side is the root of a s²
// + 2 b s + c.
inline constexpr const char* kNumberFragment = R"(
in vec3 world;
in vec3 base;
in vec3 own;
in vec3 own_ray;
uniform vec3 eye;
uniform vec3 forward;
uniform int roundness;  // 0: none, 1: about z, 2: a sphere
out vec2 result;
void main() {
  float s = 0.0;
  if (roundness == 2 || (roundness == 1 && abs(own.z) < 0.49999)) {
    vec3 kept = vec3(1.0, 1.0, float(roundness - 1));
    vec3 p = own * kept, d = own_ray * kept;
    float b = dot(p, d), c = min(dot(p, p) - 0.25, 0.0);
    s = c / max(sqrt(b * b - dot(d, d) * c) - b, 1e-6);
  }
  result = vec2(dot(world - eye, forward) * (1.0 + s), round(sqrt(base.r)));
}
)";

inline constexpr const char* kFloorNumberFragment = R"(
in vec2 world;
uniform vec3 eye;
uniform vec3 forward;
out vec2 result;
void main() { result = vec2(dot(vec3(world, 0.0) - eye, forward), 1.0); }
)";

inline constexpr const char* kFloorVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 clip_from_world;
uniform vec3 half_size;
out vec2 world;
void main() {
  world = position.xy * half_size.xy;
  gl_Position = clip_from_world * vec4(world, 0.0, 1.0);
}
)";

inline constexpr const char* kFloorFragment = R"(
in vec2 world;
uniform vec3 floor_color;
uniform sampler2D skin;
uniform vec2 picture_size;  // m; 0: there is none
out vec4 result;
// How much of this pixel the lines of the whole metres cover; far away it tends to their share of the floor.
float Lines(vec2 p, float width) {
  vec2 pixel = fwidth(p);
  vec2 drawn = clamp(vec2(width), pixel, vec2(0.5));
  vec2 soft = pixel * 1.2;
  vec2 away = abs(fract(p - 0.5) - 0.5) * 2.0;
  vec2 cover = smoothstep(drawn + soft, drawn - soft, away) * clamp(width / drawn, 0.0, 1.0);
  cover = mix(cover, vec2(width), clamp(pixel * 2.0 - 1.0, 0.0, 1.0));
  return mix(cover.x, 1.0, cover.y);
}
void main() {
  vec3 base = floor_color * floor_color;
  vec2 cell = floor(world);
  base *= 1.0 - 0.06 * mod(cell.x + cell.y, 2.0) * (1.0 - clamp(length(fwidth(world)) * 2.0, 0.0, 1.0));
  base = mix(base, base * vec3(0.50, 0.55, 0.64), Lines(world, 0.013));
  base = mix(base, base * vec3(0.50, 0.55, 0.64), 0.8 * Lines(world / 5.0, 0.006));  // every fifth is stronger
  if (picture_size.x > 0.0) {
    vec2 at = world / picture_size + 0.5;
    vec3 texel = texture(skin, vec2(at.x, 1.0 - at.y)).rgb;
    base = texel * texel;
  }
  vec3 light = Ambient(1.0) + kSunColor * sun.z + Lamps(vec3(world, 0.0), vec3(0.0, 0.0, 1.0));
  result = vec4(sqrt(base * light), 1.0);
}
)";

inline constexpr const char* kSkyVertex = R"(
layout(location = 0) in vec3 position;
uniform vec3 right;  // half the picture's width at distance 1
uniform vec3 up;
uniform vec3 forward;
out vec3 direction;
void main() {
  direction = forward + position.x * right + position.y * up;
  gl_Position = vec4(position.xy, 1.0, 1.0);
}
)";

inline constexpr const char* kSkyFragment = R"(
in vec3 direction;
out vec4 result;
void main() {
  float h = normalize(direction).z;
  vec3 horizon = vec3(0.93, 0.95, 0.97);
  vec3 above = mix(horizon, vec3(0.50, 0.66, 0.86), smoothstep(0.0, 0.75, h));
  vec3 below = mix(horizon, vec3(0.70, 0.74, 0.79), smoothstep(0.0, 1.0, -h));
  result = vec4(h > 0.0 ? above : below, 1.0);
}
)";

inline constexpr const char* kOverlayVertex = R"(
layout(location = 0) in vec4 clip;
layout(location = 1) in vec2 corner;
layout(location = 2) in vec4 color;
layout(location = 3) in float kind;
out vec2 uv;
out vec4 paint;
flat out int shape;
void main() {
  uv = corner;
  paint = color;
  shape = int(kind + 0.5);
  gl_Position = clip;
}
)";

inline constexpr const char* kOverlayFragment = R"(
in vec2 uv;
in vec4 paint;
flat in int shape;
out vec4 result;
void main() {
  float r = length(uv);
  float pixel = fwidth(r);
  float alpha = 1.0;
  float inside = 1.0 - smoothstep(1.0 - pixel, 1.0, r);
  if (shape == 1) alpha = 1.0 - smoothstep(0.35, 1.0, r);
  if (shape == 2) alpha = inside * (0.35 + 0.6 * smoothstep(0.80 - pixel, 0.80, r));
  if (shape == 3) alpha = inside;
  result = vec4(paint.rgb, paint.a * alpha);
}
)";

}  // namespace coopdyn::shaders
