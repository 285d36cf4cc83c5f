// SPDX-License-Identifier: MIT
// A look that costs little without a graphics card: light falls on the corners of triangles, and their sides only mix it. The light is that
// of MeshLambertMaterial with this view's tone mapping (three.js: NeutralToneMapping), so that pictures of both look alike.
import * as THREE from 'three';

const VERTEX = `
uniform vec3 diffuse, emissive;
varying vec3 sunny, shady;  // as shown: sRGB
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <shadowmap_pars_vertex>
#include <lights_pars_begin>

vec3 shown(vec3 c) {
  float least = min(c.r, min(c.g, c.b));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  if (peak > 0.76) {
    float most = 1.0 - 0.0576 / (peak - 0.52);
    c = mix(c * most / peak, vec3(most), 1.0 - 1.0 / (0.15 * (peak - most) + 1.0));
  }
  return mix(1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThan(c, vec3(0.0031308))));
}

void main() {
  #include <uv_vertex>
  #include <color_vertex>
  #include <beginnormal_vertex>
  #include <defaultnormal_vertex>
  #include <begin_vertex>
  #include <project_vertex>
  vec3 normal_V = normalize(transformedNormal);
#ifdef DOUBLE_SIDED
  if (dot(normal_V, mvPosition.xyz) > 0.0) normal_V = -normal_V;
#endif
  vec3 own = diffuse * RECIPROCAL_PI;
#if defined(USE_COLOR) || defined(USE_INSTANCING_COLOR)
  own *= vColor.rgb;
#endif
  vec3 sky = vec3(0.0), sun = vec3(0.0);
#if NUM_HEMI_LIGHTS > 0
  sky = getHemisphereLightIrradiance(hemisphereLights[0], normal_V);
#endif
#if NUM_DIR_LIGHTS > 0
  sun = directionalLights[0].color * max(0.0, dot(normal_V, directionalLights[0].direction));
#endif
#ifdef USE_SHADOWMAP
  shady = shown(own * sky + emissive);
#endif
  sunny = shown(own * (sky + sun) + emissive);
  // marks
  #include <worldpos_vertex>
  #include <shadowmap_vertex>
}
`;

const FRAGMENT = `
uniform float opacity;
uniform bool receiveShadow;
varying vec3 sunny, shady;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>

void main() {
#if defined(USE_SHADOWMAP) && NUM_DIR_LIGHT_SHADOWS > 0
  vec4 diffuseColor = vec4(mix(shady, sunny, getShadowMask()), opacity);
#else
  vec4 diffuseColor = vec4(sunny, opacity);
#endif
  #include <map_fragment>
  // marks
  vec3 outgoingLight = diffuseColor.rgb;
  #include <opaque_fragment>
}
`;

/** A material in the light of a sun and a sky; its texture is not to be decoded from sRGB. Lamps need another material. */
export class PlainMaterial extends THREE.MeshLambertMaterial {
  isPlain = true;

  onBeforeCompile(shader) {
    shader.vertexShader = VERTEX;
    shader.fragmentShader = FRAGMENT;
  }
}
