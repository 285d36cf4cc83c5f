// SPDX-License-Identifier: MIT
// Camera pictures as messages.
#include <array>
#include <cstring>

#include "server/devices/devices.h"

namespace coopdyn {

std::optional<ImageRequest> CameraDevice::Picture(const Message& request, const FramePtr& frame,
                                                  int robot) const {
  if (request.command != command::kGetImage) return std::nullopt;
  constexpr std::array kFormats{ImageFormat::kRgb, ImageFormat::kJpeg, ImageFormat::kDepth,
                                ImageFormat::kSegmentation};
  const auto format = static_cast<std::size_t>(request.params.empty() ? 0 : request.params.front());
  ImageRequest picture;
  picture.format = kFormats[format];
  picture.shot = CameraShot{SampleOf(frame, robot, sensor()), robot, sensor()};
  return picture;
}

Message ImageReply(command::Id command, const ImageResult& result) {
  if (!result.error.empty()) return ErrorReply(command, Error::kNotPossible, result.error);
  Message reply = ReplyTo(command, result.legend);
  const std::vector<std::uint8_t>& bytes = *result.bytes;
  const std::size_t words = (bytes.size() + 3) / 4;
  reply.params.resize(3 + words);
  reply.params[0] = result.width;
  reply.params[1] = result.height;
  reply.params[2] = static_cast<std::int32_t>(bytes.size());
  static_assert(std::endian::native == std::endian::little);
  if (!bytes.empty()) std::memcpy(&reply.params[3], bytes.data(), bytes.size());
  reply.data = {ToSeconds(result.time), static_cast<double>(result.step)};
  return reply;
}

}  // namespace coopdyn
