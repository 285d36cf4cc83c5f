// SPDX-License-Identifier: MIT
// Prints the readings of all sensors of robot1; sensor_program.py and sensor_program.m are the same program.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace {

namespace client = coopdyn::client;

void Show(const std::string& what, const std::vector<double>& values) {
  std::printf("%s", what.c_str());
  for (const double value : values) std::printf(" %.17g", value);
  std::printf("\n");
}

void Show(const client::Imu& v) {
  Show("imu", {v.qw, v.qx, v.qy, v.qz, v.wx, v.wy, v.wz, v.ax, v.ay, v.az});
}
void Show(const client::Wrench& v) {
  Show("wrench", {v.fx, v.fy, v.fz, v.tx, v.ty, v.tz});
}
void Show(const client::Battery& v) {
  Show("battery", {v.energy, v.fraction, v.power});
}
void Show(const client::Odometry& v) {
  Show("odometry", {v.x, v.y, v.heading, v.forward, v.turn});
}
void Show(const std::vector<client::Contact>& contacts) {
  for (const client::Contact& c : contacts)
    Show("contact " + c.name, {static_cast<double>(c.id), c.force, c.x, c.y, c.z, c.nx, c.ny, c.nz});
}
void Show(const client::Scan& scan) {
  for (std::size_t row = 0; row < scan.elevation.size(); ++row) {
    std::vector<double> ranges;
    for (std::size_t column = 0; column < scan.azimuth.size(); ++column)
      ranges.push_back(scan.at(row, column));
    Show("ranges", ranges);
  }
  Show("azimuth", scan.azimuth);
  Show("elevation", scan.elevation);
  Show("limits", {scan.min_range, scan.max_range});
}
void Show(const client::Image& image) {
  double sum = 0;
  for (const client::Rgb& pixel : image.data) sum += pixel.r + pixel.g + pixel.b;
  const client::Rgb a = image.rgb(2, 1), b = image.rgb(image.width - 1, 0);
  Show("image", {static_cast<double>(image.width), static_cast<double>(image.height), sum,
                 static_cast<double>(a.r), static_cast<double>(a.g), static_cast<double>(a.b),
                 static_cast<double>(b.r), static_cast<double>(b.g), static_cast<double>(b.b)});
}

void ShowPictures(client::Simulation& sim, client::Robot& r) {
  const client::Camera c = r.get_camera();
  Show("camera", {static_cast<double>(c.width), static_cast<double>(c.height), c.fx, c.fy, c.cx, c.cy, c.near,
                  c.far, c.rate});
  const client::Image image = r.get_image();
  Show(image);
  Show("when", {image.time, static_cast<double>(image.step), static_cast<double>(sim.steps())});
  Show(r.get_image("right_camera"));
  const std::vector<std::uint8_t> jpeg = r.get_jpeg();
  Show("jpeg", {static_cast<double>(jpeg.size()), static_cast<double>(jpeg[0]), static_cast<double>(jpeg[1]),
                std::accumulate(jpeg.begin(), jpeg.end(), 0.0)});
  const client::Depth depth = r.get_depth();
  std::vector<float> seen = depth.data;
  std::erase_if(seen, [](float d) { return !std::isfinite(d); });
  const auto [least, most] = std::minmax_element(seen.begin(), seen.end());
  Show("depth", {static_cast<double>(depth.width), static_cast<double>(depth.height), depth.at(2, 1),
                 depth.at(0, 2), *least, *most, static_cast<double>(depth.data.size() - seen.size())});
  const client::Segmentation labels = r.get_segmentation();
  Show("segmentation",
       {static_cast<double>(labels.width), static_cast<double>(labels.height),
        static_cast<double>(labels.at(2, 1)), std::accumulate(labels.data.begin(), labels.data.end(), 0.0)});
  for (const auto& [number, name] : labels.names) std::printf("name %d %s\n", number, name.c_str());
}

void Run() {
  client::Simulation sim = client::connect();
  client::Robot r = sim.robot("robot1");
  sim.step(7);
  Show(r.get_imu());
  Show(r.get_imu("mast_imu"));
  Show(r.get_wrench());
  Show(r.get_scan());
  Show(r.get_scan("rear_lidar"));
  Show(r.get_contacts());
  const std::vector<bool> pressed = r.get_bumper();
  Show("bumper", {pressed.begin(), pressed.end()});
  Show("sonar", r.get_sonar());
  Show("infrared", r.get_infrared());
  Show("light", r.get_light());
  Show(r.get_battery());
  Show(r.get_odometry());
  ShowPictures(sim, r);
  for (int k = 0; k < 3; ++k) {
    sim.step();
    const client::Reading s = r.sense();
    Show("sense", {s.time, static_cast<double>(s.step), static_cast<double>(sim.steps())});
    Show(s.imu.value());
    Show(s.wrench.value());
    Show(s.scan.value());
    Show(s.contacts);
    Show("sonar", s.sonar);
    Show("infrared", s.infrared);
    Show("light", s.light);
    Show(s.battery.value());
    Show(s.odometry.value());
    const double shown = static_cast<double>(r.get_image().step);
    Show("when", {shown, static_cast<double>(sim.steps())});
  }
  r.subscribe("light");
  r.subscribe("rear_lidar");
  sim.step();
  Show("pushed", r.next("light", 10).value);
  Show("pushed", r.next("rear_lidar", 10).value);
  sim.close();
}

}  // namespace

int main() try {
  Run();
  return 0;
} catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
