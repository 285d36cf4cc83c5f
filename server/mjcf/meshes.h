// SPDX-License-Identifier: MIT
// Writes a model's meshes as files, each on first use. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "server/mjcf/source.h"

namespace coopdyn::mjcf {

class Meshes {
 public:
  /// Writes files to `folder`; the SDF refers to them as `prefix` + name.
  Meshes(const Source& source, std::filesystem::path folder, std::string prefix)
      : source_(source), folder_(std::move(folder)), prefix_(std::move(prefix)) {}

  /// The <uri> of a mesh, and its <scale>, usually empty.
  struct Named {
    std::string uri, scale;
  };
  Named Mesh(int mesh);
  /// A height field as a mesh.
  Named Heights(int field);
  bool failed() const { return failed_; }  // a file could not be written

 private:
  struct Triangles;
  /// A unique file name.
  std::string NewFile(const std::string& name);
  std::string Copy(const UnreadMesh& mesh);
  std::string Write(const std::string& name, const Triangles& triangles);

  const Source& source_;
  const std::filesystem::path folder_;
  const std::string prefix_;
  std::map<std::string, Named> written_;       // by kind and index
  std::map<std::string, std::string> copied_;  // file name in folder_, by the original's path
  std::set<std::string> files_;                // file names in use
  bool failed_ = false;
};

}  // namespace coopdyn::mjcf
