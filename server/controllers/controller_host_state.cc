// SPDX-License-Identifier: MIT
// Save() and Restore(): little-endian, in the daemon's own words; a keyframe holds them.
//   u32 version, u32 count, then for each robot with a controller by increasing id:
//   u32 id, u8 status, u32 size of the controller's name, name, u32 size of the reason, reason, u32 size,
//   state
#include <string>
#include <utility>

#include "server/controllers/controller_host.h"

namespace coopdyn {

namespace {

constexpr std::uint32_t kVersion = 1;

class ByteWriter {
 public:
  void Number(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) Byte(static_cast<std::uint8_t>(value >> shift));
  }
  void Byte(std::uint8_t value) { bytes_.push_back(static_cast<std::byte>(value)); }
  void Bytes(std::span<const std::byte> bytes) {
    Number(static_cast<std::uint32_t>(bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void Text(const std::string& text) { Bytes(std::as_bytes(std::span(text))); }
  std::vector<std::byte> Take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads what ByteWriter writes; after a read beyond the end `good()` is false and all that is read is 0.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool good() const { return good_; }
  bool at_end() const { return bytes_.empty(); }

  std::uint32_t Number() {
    std::uint32_t value = 0;
    const std::span<const std::byte> taken = Take(4);
    for (std::size_t i = 0; i < taken.size(); ++i) value |= static_cast<std::uint32_t>(taken[i]) << (8 * i);
    return value;
  }
  std::uint8_t Byte() {
    const std::span<const std::byte> taken = Take(1);
    return taken.empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(taken[0]);
  }
  std::vector<std::byte> Bytes() {
    const std::span<const std::byte> taken = Take(Number());
    return {taken.begin(), taken.end()};
  }
  std::string Text() {
    const std::span<const std::byte> taken = Take(Number());
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

 private:
  std::span<const std::byte> Take(std::size_t count) {
    good_ = good_ && count <= bytes_.size();
    if (!good_) return {};
    const std::span<const std::byte> taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

  std::span<const std::byte> bytes_;
  bool good_ = true;
};

}  // namespace

std::vector<std::byte> ControllerHost::Save() const {
  ByteWriter writer;
  writer.Number(kVersion);
  writer.Number(static_cast<std::uint32_t>(driven_.size()));
  for (const Driven& driven : driven_) {
    writer.Number(driven.id.value);
    writer.Byte(static_cast<std::uint8_t>(driven.status));
    writer.Text(driven.controller);
    writer.Text(driven.why);
    const bool drives = driven.status == Status::kDrives && set_;
    writer.Bytes(drives ? set_->StateOf(driven.slot) : std::span<const std::byte>());
  }
  return writer.Take();
}

bool ControllerHost::Restore(const FramePtr& frame, std::span<const std::byte> saved) {
  List(*frame->scene);
  ByteReader reader(saved);
  bool fits = reader.Number() == kVersion && reader.Number() == driven_.size();
  std::vector<Driven> restored = driven_;
  for (std::size_t i = 0; fits && i < restored.size(); ++i) {
    Driven& driven = restored[i];
    fits = reader.Number() == driven.id.value;
    const std::uint8_t status = reader.Byte();
    fits =
        fits && status <= static_cast<std::uint8_t>(Status::kUnloaded) && reader.Text() == driven.controller;
    driven.status = static_cast<Status>(status);
    driven.why = reader.Text();
    driven.restored = reader.Bytes();
    fits = fits && reader.good();
  }
  fits = fits && reader.at_end();
  if (fits) driven_ = std::move(restored);
  std::vector<StoppedController> before;
  for (const Driven& driven : driven_) {
    if (driven.status == Status::kStopped) before.push_back({driven.name, driven.why});
  }
  Create(frame);
  stopped_.insert(stopped_.end(), before.begin(), before.end());
  return fits;
}

}  // namespace coopdyn
