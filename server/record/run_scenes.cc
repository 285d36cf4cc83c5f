// SPDX-License-Identifier: MIT
// Decodes the scenes of a recording with its embedded models and textures.
#include <utility>

#include "server/record/run_reader.h"
#include "server/record/run_tables.h"
#include "server/record/state_codec.h"

namespace coopdyn {

std::shared_ptr<const Scene> RunReader::FindScene(std::uint64_t number) {
  if (const auto known = scenes_.find(number); known != scenes_.end()) return known->second;
  const std::string name = "scene " + std::to_string(number);
  if (scenario_ == nullptr) {
    throw Failure{file_ + ": " + name + " needs the scenario, which has not been loaded"};
  }
  Statement row = database().Prepare("SELECT description FROM scene WHERE id = ?1");
  row.Bind(1, number);
  if (!row.Step()) Damaged("a step of " + name + ", which is missing");
  const FindModel model = ModelFinder();
  const FindTexture texture = TextureFinder();
  std::shared_ptr<const Scene> scene = DecodeScene(row.blob(0), scenario_, model, texture);
  if (scene == nullptr) {  // perhaps a robot type added while the file is read
    ReadTextsAgain();
    scene = DecodeScene(row.blob(0), scenario_, model, texture);
  }
  if (scene == nullptr) Damaged(name);
  scenes_.emplace(number, scene);
  return scene;
}

FindModel RunReader::ModelFinder() {
  return [this](const std::string& type) -> std::shared_ptr<const RobotModel> {
    for (const RobotEntry& robot : scenario_->robots) {
      if (robot.model->type == type) return robot.model;
    }
    Diagnostics ignored;
    return library_->Get(type, SourceLine{file_, 0}, ignored);
  };
}

FindTexture RunReader::TextureFinder() {
  return [this](const std::string& key) {
    Texture found;
    const SourceText* source = library_->Embedded("texture", key);
    if (source == nullptr) return found;
    std::shared_ptr<const Image>& image = images_[key];
    if (image == nullptr) image = EmbeddedTexture(*source);
    found.image = image;
    found.source = std::make_shared<const SourceText>(*source);
    return found;
  };
}

void RunReader::ReadTextsAgain() {
  RunHeader header;
  if (!ReadHeader(database(), header).empty() || header.sources.size() == header_.sources.size()) return;
  header_.sources = std::move(header.sources);
  library_ = std::make_unique<RobotLibrary>(library_->path(), header_.sources);
}

}  // namespace coopdyn
