// SPDX-License-Identifier: MIT
// Reads meshes and pictures with third-party libraries in a separate process, coopdyn-files, with limits on
// time and memory. A file that crashes a library or keeps it busy forever is then only an unreadable file.
// The process starts with the first file and restarts after a file has ended it. One thread at a time.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/files/wire.h"

namespace coopdyn {

class FileReader {
 public:
  /// Limits for one file.
  struct Limits {
    int cpu_s = 10;
    int memory_mib = 2048;
  };
  /// Returns the content of the file `name` that a mesh refers to: a texture or another file. Returns nullopt
  /// and sets `why` if the file is unavailable.
  using Supply =
      std::function<std::optional<std::string>(bool is_texture, const std::string& name, std::string& why)>;

  FileReader() = default;
  explicit FileReader(Limits limits) : limits_(limits) {}
  ~FileReader() { End(); }
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  /// These return nullopt or null if the file cannot be read; `why` then says what to do.
  std::optional<MeshAnswer> ReadMesh(const MeshRequest& request, const Supply& supply, std::string& why);
  std::shared_ptr<const Image> ReadTexture(std::string_view bytes, std::string& why);
  std::optional<Heights> ReadHeights(std::string_view bytes, std::string& why);

 private:
  /// Returns the bytes of the answer, which must be of kind `wanted`.
  std::optional<std::vector<std::byte>> Ask(FileTalk kind, std::span<const std::byte> bytes,
                                            const Supply& supply, FileTalk wanted, std::string& why);
  bool Start(std::string& why);
  /// Ends the process and returns its wait status.
  int End();
  /// Explains a wait status.
  std::string WhyEnded(int status) const;

  const Limits limits_;
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace coopdyn
