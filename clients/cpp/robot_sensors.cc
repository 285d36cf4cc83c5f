// SPDX-License-Identifier: MIT
// Readings of the sensors of robot models.
#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/links.h"
#include "clients/cpp/sensor_values.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

static_assert(std::endian::native == std::endian::little, "pictures are little-endian");
static_assert(sizeof(Rgb) == 3);

enum Format : std::int32_t { kRgb, kJpeg, kDepth, kSegmentation };

/// The data of a reply without the final two. Throws Error 7 if they are fewer than `count`.
std::span<const double> DataOf(const Message& reply, std::size_t count) {
  Require(reply, 0, count);
  return std::span(reply.data).first(reply.data.size() - 2);
}

std::vector<double> RowOf(const Message& reply) {
  const std::span<const double> data = DataOf(reply, 0);
  return {data.begin(), data.end()};
}

/// Copies the bytes of a picture, four per param after the first three.
template <class T>
std::vector<T> BytesOf(const Message& reply) {
  Require(reply, 3, 0);
  const std::size_t count = static_cast<std::size_t>(std::max(0, reply.params[2]));
  if (count > 4 * (reply.params.size() - 3)) throw Error(7, "a reply of the daemon has too few values");
  std::vector<T> values(count / sizeof(T));
  if (!values.empty())
    std::memcpy(static_cast<void*>(values.data()), reply.params.data() + 3, count / sizeof(T) * sizeof(T));
  return values;
}

template <class T, class Picture>
Picture ToPicture(const Message& reply) {
  Picture picture;
  picture.data = BytesOf<T>(reply);
  picture.width = reply.params[0];
  picture.height = reply.params[1];
  picture.time = TimeOf(reply);
  picture.step = StepOf(reply);
  if (picture.data.size() != static_cast<std::size_t>(picture.width) * picture.height)
    throw Error(7, "a picture of the daemon has a wrong number of bytes");
  return picture;
}

}  // namespace

Imu ToImu(std::span<const double> d) {
  return {d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8], d[9]};
}

Wrench ToWrench(std::span<const double> d) {
  return {d[0], d[1], d[2], d[3], d[4], d[5]};
}

Battery ToBattery(std::span<const double> d) {
  return {d[0], d[1], d[2]};
}

Odometry ToOdometry(std::span<const double> d) {
  return {d[0], d[1], d[2], d[3], d[4]};
}

std::vector<Contact> ToContacts(std::span<const double> d) {
  std::vector<Contact> contacts;
  for (; d.size() >= 7; d = d.subspan(7))
    contacts.push_back({-1, "", d[0], d[1], d[2], d[3], d[4], d[5], d[6]});
  return contacts;
}

Scan ToScan(RobotLink& link, const std::string& module, std::span<const double> ranges) {
  ScanGeometry& g = link.scans[module];
  if (g.rows * g.columns != ranges.size()) {
    const Message reply = link.Read(module, {command::kGetScanGeometry});
    const std::span<const double> d = DataOf(reply, 8);
    g = {d[0], d[1], d[2], d[3], static_cast<std::size_t>(Whole(d[4])), static_cast<std::size_t>(Whole(d[5])),
         d[6], d[7]};
    if (g.rows * g.columns != ranges.size())
      throw Error(7, "a scan of the daemon has a wrong number of ranges");
  }
  Scan scan{{ranges.begin(), ranges.end()}, {}, {}, g.min_range, g.max_range};
  for (std::size_t k = 0; k < g.columns; ++k)
    scan.azimuth.push_back(g.first + static_cast<double>(k) * g.increment);
  for (std::size_t k = 0; k < g.rows; ++k) scan.elevation.push_back(g.low + static_cast<double>(k) * g.step);
  return scan;
}

Imu Robot::get_imu(const std::string& module) {
  return ToImu(DataOf(link_->Read(module, {command::kGetImu}), 10));
}

Wrench Robot::get_wrench(const std::string& module) {
  return ToWrench(DataOf(link_->Read(module, {command::kGetWrench}), 6));
}

Scan Robot::get_scan(const std::string& module) {
  return ToScan(*link_, module, RowOf(link_->Read(module, {command::kGetScan})));
}

std::vector<Contact> Robot::get_contacts(const std::string& module) {
  const Message reply = link_->Read(module, {command::kGetContacts});
  std::vector<Contact> contacts = ToContacts(DataOf(reply, 0));
  const std::vector<std::string> names = Words(reply.text);
  for (std::size_t k = 0; k < std::min({contacts.size(), names.size(), reply.params.size()}); ++k) {
    contacts[k].id = reply.params[k];
    contacts[k].name = names[k];
  }
  return contacts;
}

std::vector<bool> Robot::get_bumper(const std::string& module) {
  std::vector<bool> pressed;
  for (const double value : RowOf(link_->Read(module, {command::kGetBumper}))) pressed.push_back(value != 0);
  return pressed;
}

Image Robot::get_image(const std::string& module) {
  return ToPicture<Rgb, Image>(link_->Read(module, {command::kGetImage, {kRgb}}));
}

std::vector<std::uint8_t> Robot::get_jpeg(const std::string& module) {
  return BytesOf<std::uint8_t>(link_->Read(module, {command::kGetImage, {kJpeg}}));
}

Depth Robot::get_depth(const std::string& module) {
  return ToPicture<float, Depth>(link_->Read(module, {command::kGetImage, {kDepth}}));
}

Segmentation Robot::get_segmentation(const std::string& module) {
  const Message reply = link_->Read(module, {command::kGetImage, {kSegmentation}});
  Segmentation labels = ToPicture<std::uint16_t, Segmentation>(reply);
  for (const std::string& word : Words(reply.text)) {
    const std::size_t at = word.find('=');
    if (at == std::string::npos || at == 0 || at > 9 || word.find_first_not_of("0123456789") != at) continue;
    labels.names[std::stoi(word)] = word.substr(at + 1);
  }
  return labels;
}

Camera Robot::get_camera(const std::string& module) {
  const Message reply = link_->Read(module, {command::kGetCamera});
  const std::span<const double> d = DataOf(reply, 9);
  return {
      static_cast<int>(Whole(d[0])), static_cast<int>(Whole(d[1])), d[2], d[3], d[4], d[5], d[6], d[7], d[8]};
}

Battery Robot::get_battery(const std::string& module) {
  return ToBattery(DataOf(link_->Read(module, {command::kGetBattery}), 3));
}

std::vector<double> Robot::get_light(const std::string& module) {
  return RowOf(link_->Read(module, {command::kGetLight}));
}

std::vector<double> Robot::get_sonar(const std::string& module) {
  return RowOf(link_->Read(module, {command::kGetSonar}));
}

std::vector<double> Robot::get_infrared(const std::string& module) {
  return RowOf(link_->Read(module, {command::kGetInfrared}));
}

Odometry Robot::get_odometry(const std::string& module) {
  return ToOdometry(DataOf(link_->Read(module, {command::kGetOdometry}), 5));
}

}  // namespace coopdyn::client
