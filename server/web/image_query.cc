// SPDX-License-Identifier: MIT
#include "server/web/image_query.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "protocol/text_numbers.h"
#include "server/naming/run_names.h"

namespace coopdyn {
namespace {

std::string ReadPixels(std::string_view key, std::string_view text, int& pixels) {
  std::int32_t value = 0;
  if (ReadInt32(text, value) != NumberRead::kOk) {
    return std::string(key) + " must be a whole number of pixels, e.g. " + std::string(key) + "=640";
  }
  pixels = value;
  return {};
}

std::string ReadPoint(std::string_view key, std::string_view text, std::optional<Vector3>& point) {
  Vector3 read;
  int count = 0;
  std::string_view rest = text;
  for (bool more = true; more; ++count) {
    const auto comma = rest.find(',');
    more = comma != std::string_view::npos;
    double value = 0;
    if (count == 3 || ReadDouble(rest.substr(0, comma), value) != NumberRead::kOk) {
      count = 0;
      break;
    }
    read[count] = value;
    rest.remove_prefix(more ? comma + 1 : rest.size());
  }
  if (count != 3) {
    return std::string(key) + " must be three numbers in metres, e.g. " + std::string(key) + "=-3,0,2";
  }
  point = read;
  return {};
}

std::string ReadFlag(std::string_view key, std::string_view text, bool& flag) {
  if (text != "0" && text != "1") return std::string(key) + " must be 0 or 1";
  flag = text == "1";
  return {};
}

std::string ReadParameter(std::string_view key, std::string_view text, ImageRequest& request) {
  if (key == "w") return ReadPixels(key, text, request.width);
  if (key == "h") return ReadPixels(key, text, request.height);
  if (key == "eye") return ReadPoint(key, text, request.eye_m);
  if (key == "look") return ReadPoint(key, text, request.look_m);
  if (key == "rays") return ReadFlag(key, text, request.show_rays);
  return "unknown parameter " + Quoted(key) + ": write w, h, eye, look or rays";
}

}  // namespace

std::string ReadImageQuery(std::string_view query, ImageRequest& request) {
  while (!query.empty()) {
    const auto end = query.find('&');
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(end == std::string_view::npos ? query.size() : end + 1);
    if (pair.empty()) continue;
    const auto equals = pair.find('=');
    std::string coded(equals == std::string_view::npos ? "" : pair.substr(equals + 1));
    std::replace(coded.begin(), coded.end(), '+', ' ');
    const std::optional<std::string> value = PercentDecode(coded);
    if (!value) return "badly escaped: " + Quoted(pair);
    if (std::string error = ReadParameter(pair.substr(0, equals), *value, request); !error.empty())
      return error;
  }
  return CheckImageRequest(request);
}

}  // namespace coopdyn
