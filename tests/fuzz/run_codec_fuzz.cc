// SPDX-License-Identifier: MIT
// Feeds arbitrary bytes to the decoders of a run file's contents: columns of a step, poses, exact states and
// scenes. Nothing may crash, read past the bytes, or fill memory; a decoder's result must be encodable.

// link: coopdyn_record coopdyn_state

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "server/record/recorded_step.h"
#include "server/record/state_codec.h"
#include "server/state/pose_codec.h"

namespace {

using coopdyn::DistanceModel;
using coopdyn::RobotModel;
using coopdyn::SectorModel;

/// A scenario of one robot, without a file; it may have sensors whose values physics measures.
std::shared_ptr<const coopdyn::Scenario> MakeScenario(bool measured) {
  auto model = std::make_shared<RobotModel>();
  model->type = "r";
  model->links.resize(1);
  model->AddSensor("distance", DistanceModel{std::vector<SectorModel>(2)});
  if (measured) {
    model->AddSensor("imu", coopdyn::ImuModel());
    model->AddSensor("contact", coopdyn::ContactModel());
  }
  auto scenario = std::make_shared<coopdyn::Scenario>();
  scenario->robots.resize(1);
  scenario->robots[0].name = "robot1";
  scenario->robots[0].model = model;
  return scenario;
}

void Require(bool fine) {
  if (!fine) std::abort();
}

void DecodeColumns(std::span<const std::byte> bytes, const coopdyn::Scene& measured) {
  std::vector<std::byte> again;
  std::vector<coopdyn::CommandRecord> commands;
  if (coopdyn::DecodeCommands(bytes, commands)) {
    coopdyn::EncodeCommands(commands, again);
    Require(again.size() == bytes.size());
  }
  again.clear();
  std::vector<coopdyn::SentMessage> messages;
  if (coopdyn::DecodeMessages(bytes, 7, messages)) {
    coopdyn::EncodeMessages(messages, again);
    Require(again.size() == bytes.size());
  }
  again.clear();
  std::vector<coopdyn::Score> scores;
  if (coopdyn::DecodeScores(bytes, scores)) {
    coopdyn::EncodeScores(scores, again);
    Require(again.size() == bytes.size());
  }
  std::vector<float> values;
  if (coopdyn::DecodeFloats(bytes, values)) Require(values.size() * sizeof(float) == bytes.size());
  for (const std::size_t channels : {0, 1, 3}) {
    std::vector<coopdyn::ChannelMotion> motions(channels);
    coopdyn::SensedStep sensed;
    if (!coopdyn::DecodeChannels(bytes, measured, motions, sensed)) continue;
    for (const coopdyn::Contact& contact : sensed.contacts) Require(coopdyn::Fits(contact, measured));
  }
  std::vector<coopdyn::BodyState> bodies(bytes.size() / coopdyn::kPoseBytes);
  if (coopdyn::DecodePoses(bytes, bodies)) {
    for (const coopdyn::BodyState& body : bodies) Require(body.p_WB.allFinite());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::shared_ptr<const coopdyn::Scenario> scenario = MakeScenario(false);
  static const std::shared_ptr<const coopdyn::Scene> scene = coopdyn::MakeScene(scenario);
  static const std::shared_ptr<const coopdyn::Scene> measured = coopdyn::MakeScene(MakeScenario(true));
  const auto bytes = std::as_bytes(std::span(data, size));
  DecodeColumns(bytes, *measured);
  const coopdyn::SavedStatePtr state = coopdyn::DecodeState(bytes, scene);
  if (state != nullptr) Require(!coopdyn::EncodeState(*state).empty());
  const auto model = [](const std::string& type) {
    return type == "r" ? scenario->robots[0].model : nullptr;
  };
  const auto decoded = coopdyn::DecodeScene(bytes, scenario, model);
  if (decoded != nullptr) Require(!coopdyn::EncodeScene(*decoded).empty());
  return 0;
}
