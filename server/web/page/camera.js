// SPDX-License-Identifier: MIT
// The viewer's camera: it orbits the point it looks at. No DOM. Frame: world, z up; metres and radians.

const MAX_ELEVATION = 1.55;
const MIN_ELEVATION = -0.2;
const MIN_DISTANCE = 0.05;
const MAX_DISTANCE = 1000;
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

export class Camera {
  /** Free: the server frames the whole scene. */
  free = true;
  look = [0, 0, 0];
  distance = 5;
  azimuth = Math.PI;
  elevation = 0.6;

  get eye() {
    const flat = this.distance * Math.cos(this.elevation);
    return [
      this.look[0] + flat * Math.cos(this.azimuth),
      this.look[1] + flat * Math.sin(this.azimuth),
      this.look[2] + this.distance * Math.sin(this.elevation),
    ];
  }

  /** Adopts the pose of the server's camera. */
  adopt(eye, look) {
    const d = [0, 1, 2].map((i) => eye[i] - look[i]);
    this.look = [...look];
    this.distance = clamp(Math.hypot(...d), MIN_DISTANCE, MAX_DISTANCE);
    this.elevation = clamp(Math.asin(clamp(d[2] / this.distance, -1, 1)), MIN_ELEVATION, MAX_ELEVATION);
    if (Math.hypot(d[0], d[1]) > 1e-9) this.azimuth = Math.atan2(d[1], d[0]);
  }

  rotate(azimuth, elevation) {
    this.free = false;
    this.azimuth += azimuth;
    this.elevation = clamp(this.elevation + elevation, MIN_ELEVATION, MAX_ELEVATION);
  }

  /** Moves along the floor: `right` and `ahead` as seen on the screen, in fractions of the picture's height. */
  translate(right, ahead) {
    this.free = false;
    const scale = 0.845 * this.distance;  // the height visible at that distance: 2 tan(0.4)
    const c = Math.cos(this.azimuth);
    const s = Math.sin(this.azimuth);
    this.look[0] += scale * (-s * right - c * ahead);
    this.look[1] += scale * (c * right - s * ahead);
  }

  zoom(factor) {
    this.free = false;
    this.distance = clamp(this.distance * factor, MIN_DISTANCE, MAX_DISTANCE);
  }
}
