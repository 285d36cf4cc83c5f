// SPDX-License-Identifier: MIT
#include "server/model/kept_parts.h"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <utility>

#include "server/base/random.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

/// Increment it whenever the results of CutConvex() may change.
constexpr std::uint64_t kVersion = 1;
constexpr std::string_view kExtension = ".parts";
constexpr std::size_t kMostFiles = 2000;
constexpr std::uintmax_t kMostPartBytes = 1u << 20;

template <typename T>
void Put(const T& value, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
template <typename T>
bool TakeValue(std::string_view& bytes, T& value) {
  if (bytes.size() < sizeof(value)) return false;
  std::memcpy(&value, bytes.data(), sizeof(value));
  bytes.remove_prefix(sizeof(value));
  return true;
}

std::string HeadOf(const MeshData& mesh, int most, int cells) {
  std::string head = "coopdyn parts\n";
  for (const std::uint64_t number :
       {kVersion, mesh.id, std::uint64_t{mesh.vertices.size()}, std::uint64_t{mesh.triangles.size()},
        static_cast<std::uint64_t>(most), static_cast<std::uint64_t>(cells)})
    Put(number, head);
  return head;
}

std::optional<PartCorners> ReadParts(const fs::path& file, const MeshData& mesh, int most, int cells) {
  std::error_code code;
  const auto size = fs::file_size(file, code);
  if (code || size > kMostPartBytes || !fs::is_regular_file(file, code)) return std::nullopt;
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
  return PartsFromBytes(bytes, mesh, most, cells);
}

/// Removes the older files if there are too many, so that half remain.
void RemoveOldest(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    if (it->path().extension() == kExtension) files.emplace_back(it->last_write_time(code), it->path());
  }
  if (files.size() < kMostFiles) return;
  std::ranges::sort(files);
  for (std::size_t i = 0; i < files.size() - kMostFiles / 2; ++i) fs::remove(files[i].second, code);
}

/// Writes atomically, so that other processes never see a partial file.
void WriteParts(const std::string& bytes, const fs::path& file) {
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  RemoveOldest(file.parent_path());
  std::string unfinished = file.string() + ".XXXXXX";
  const int descriptor = mkstemp(unfinished.data());
  if (descriptor < 0) return;
  const bool written = write(descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  const bool closed = close(descriptor) == 0;
  if (written && closed) fs::rename(unfinished, file, code);
  if (!written || !closed || code) fs::remove(unfinished, code);
}

}  // namespace

std::string PartsToBytes(const PartCorners& parts, const MeshData& mesh, int most, int cells) {
  std::string bytes = HeadOf(mesh, most, cells);
  Put(std::uint64_t{parts.size()}, bytes);
  for (const auto& corners : parts) {
    Put(std::uint64_t{corners.size()}, bytes);
    for (const Vector3& corner : corners) {
      for (const double x : corner) Put(x, bytes);
    }
  }
  Put(HashOfBytes(bytes), bytes);
  return bytes;
}

std::optional<PartCorners> PartsFromBytes(std::string_view bytes, const MeshData& mesh, int most, int cells) {
  std::uint64_t hash = 0, count = 0;
  const std::string head = HeadOf(mesh, most, cells);
  if (bytes.size() < head.size() + sizeof(hash) || !bytes.starts_with(head)) return std::nullopt;
  std::string_view end = bytes.substr(bytes.size() - sizeof(hash));
  bytes.remove_suffix(sizeof(hash));
  if (!TakeValue(end, hash) || hash != HashOfBytes(bytes)) return std::nullopt;
  bytes.remove_prefix(head.size());
  if (!TakeValue(bytes, count) || count > static_cast<std::uint64_t>(most)) return std::nullopt;
  PartCorners parts(count);
  constexpr std::uint64_t kMostCorners = 300;
  const Vector3 reach_m = mesh.half_m + Vector3::Constant(0.01);
  for (auto& corners : parts) {
    if (!TakeValue(bytes, count) || count > kMostCorners) return std::nullopt;
    corners.resize(count);
    for (Vector3& corner : corners) {
      for (double& x : corner) {
        if (!TakeValue(bytes, x)) return std::nullopt;
      }
      if (!(corner.cwiseAbs().array() <= reach_m.array()).all()) return std::nullopt;
    }
    Vector3 ignored;
    if (!ConvexHull(corners, ignored)) return std::nullopt;
  }
  return bytes.empty() ? std::optional(std::move(parts)) : std::nullopt;
}

ConvexCut KeptConvexCut(const MeshData& mesh, int most, const fs::path& folder, int cells) {
  constexpr std::size_t kFewTriangles = 100;  // blocks, which take a few milliseconds
  if (most < 2) return {};
  if (folder.empty() || mesh.triangles.size() < kFewTriangles)
    return CutConvex(mesh.vertices, mesh.triangles, most, cells);
  const std::string key = HeadOf(mesh, most, cells);
  const std::uint64_t name = HashOfBytes(key);
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += kDigits[name >> shift & 15u];
  const fs::path file = folder / (digits + std::string(kExtension));
  if (auto kept = ReadParts(file, mesh, most, cells)) return {*std::move(kept)};
  ConvexCut cut = CutConvex(mesh.vertices, mesh.triangles, most, cells);
  if (!cut.is_tangled) WriteParts(PartsToBytes(cut.parts, mesh, most, cells), file);
  return cut;
}

}  // namespace coopdyn
