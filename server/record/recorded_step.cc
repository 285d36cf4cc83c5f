// SPDX-License-Identifier: MIT
#include "server/record/recorded_step.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/record/state_codec.h"
#include "server/sensing/readings.h"
#include "server/state/pose_codec.h"

namespace coopdyn {

namespace {

struct Word {
  const char* text;
  bool RecordWhat::*chosen;
};
constexpr std::array<Word, 5> kWords{{{"channels", &RecordWhat::channels},
                                      {"distances", &RecordWhat::distances},
                                      {"targets", &RecordWhat::targets},
                                      {"controllers", &RecordWhat::controllers},
                                      {"images", &RecordWhat::images}}};

constexpr std::uint32_t kByClient = std::uint32_t{1} << 31;
constexpr std::size_t kCommandBytes = 4 + 1 + 8;
constexpr std::size_t kManyRobots = 50;

}  // namespace

std::string ToString(const RecordWhat& what) {
  std::string words = "poses";
  for (const Word& word : kWords) {
    if (what.*word.chosen) words += std::string(",") + word.text;
  }
  return words;
}

std::optional<RecordWhat> ParseRecordWhat(const std::string& words, std::string& unknown) {
  RecordWhat what;
  std::size_t start = 0;
  while (start <= words.size()) {
    const std::size_t end = std::min(words.find(',', start), words.size());
    std::string word = words.substr(start, end - start);
    std::erase_if(word, [](char c) { return c == ' ' || c == '\t'; });
    start = end + 1;
    if (word == "poses") continue;
    if (word == "all") {
      what = {true, true, true, true, what.images};
      continue;
    }
    const auto* found =
        std::find_if(kWords.begin(), kWords.end(), [&](const Word& known) { return word == known.text; });
    if (found == kWords.end()) {
      unknown = word;
      return {};
    }
    what.*found->chosen = true;
  }
  return what;
}

RecordWhat DefaultRecordWhat(std::size_t robots) {
  const bool few = robots <= kManyRobots;
  return {few, few, few, true, false};
}

bool SameBits(const Setpoint& a, const Setpoint& b) {
  return a.mode == b.mode &&
         std::bit_cast<std::uint64_t>(a.reference) == std::bit_cast<std::uint64_t>(b.reference);
}

void EncodeCommands(std::span<const CommandRecord> commands, std::vector<std::byte>& blob) {
  ByteWriter writer(blob);
  for (const CommandRecord& command : commands) {
    writer.Number(command.channel | (command.by_client ? kByClient : 0));
    CodeSetpoint(writer, command.setpoint);
  }
}

bool DecodeCommands(std::span<const std::byte> blob, std::vector<CommandRecord>& commands) {
  commands.clear();
  if (blob.size() % kCommandBytes != 0) return false;
  commands.resize(blob.size() / kCommandBytes);
  ByteReader reader(blob);
  for (CommandRecord& command : commands) {
    reader.Number(command.channel);
    command.by_client = (command.channel & kByClient) != 0;
    command.channel &= ~kByClient;
    CodeSetpoint(reader, command.setpoint);
    reader.Require(&command == commands.data() || command.channel > (&command - 1)->channel);
  }
  if (!reader.ok()) commands.clear();
  return reader.ok();
}

void EncodeMessages(std::span<const SentMessage> messages, std::vector<std::byte>& blob) {
  ByteWriter writer(blob);
  for (const SentMessage& sent : messages) {
    writer.Number(sent.robot);
    CodeMessage(writer, sent.message);
  }
}

bool DecodeMessages(std::span<const std::byte> blob, std::uint64_t step, std::vector<SentMessage>& messages) {
  messages.clear();
  ByteReader reader(blob);
  while (reader.left() > 0) {
    SentMessage& sent = messages.emplace_back();
    sent.step = step;
    reader.Number(sent.robot);
    CodeMessage(reader, sent.message);
  }
  if (!reader.ok()) messages.clear();
  return reader.ok();
}

void EncodeChannels(std::span<const ChannelState> channels, std::vector<std::byte>& blob) {
  ByteWriter writer(blob);
  for (const ChannelState& channel : channels) {
    writer.Low(EncodePosition(channel.position), 5);
    writer.Number(static_cast<float>(channel.velocity));
  }
}

namespace {

void CodeEnd(auto& codec, auto& end) {
  codec.Number(end.object);
  codec.Number(end.robot);
  codec.Number(end.link);
  codec.Number(end.collision);
}

bool Fits(const ContactEnd& end, const Scene& scene) {
  if (end.robot < 0) return end.object < static_cast<std::int32_t>(scene.objects.size());
  if (end.robot >= static_cast<std::int32_t>(scene.robots.size())) return false;
  const RobotModel& model = *scene.robots[static_cast<std::size_t>(end.robot)].entry.model;
  if (end.link < 0 || end.link >= static_cast<std::int32_t>(model.links.size())) return false;
  const auto shapes = model.links[static_cast<std::size_t>(end.link)].collisions.size();
  return end.collision >= 0 && end.collision < static_cast<std::int32_t>(shapes);
}

constexpr std::size_t kContactBytes = 2 * 4 * 4 + 9 * 4;

}  // namespace

bool Fits(const Contact& contact, const Scene& scene) {
  return Fits(contact.a, scene) && Fits(contact.b, scene);
}

void EncodeSensed(const Frame& frame, std::vector<std::byte>& blob) {
  ByteWriter writer(blob);
  for (const double value : frame.measured) writer.Number(static_cast<float>(value));
  if (!frame.scene->measures_contacts) return;
  writer.List(frame.contacts, kContactBytes, [&writer](const Contact& contact) {
    CodeEnd(writer, contact.a);
    CodeEnd(writer, contact.b);
    for (const Vector3& v : {contact.p_W, contact.normal_W, contact.force_W}) {
      for (const double x : v) writer.Number(static_cast<float>(x));
    }
  });
}

bool DecodeChannels(std::span<const std::byte> blob, const Scene& scene, std::span<ChannelMotion> channels,
                    SensedStep& sensed) {
  ByteReader reader(blob);
  for (ChannelMotion& channel : channels) {
    channel.position = DecodePosition(reader.Low(5));
    float velocity = 0;
    reader.Finite(velocity);
    channel.velocity = velocity;
  }
  sensed = {};
  if (reader.finished()) return true;
  float value = 0;
  for (int i = 0; i < scene.measured_count; ++i) {
    reader.Finite(value);
    sensed.measured.push_back(value);
  }
  if (!scene.measures_contacts) return reader.finished();
  reader.List(sensed.contacts, kContactBytes, [&](Contact& contact) {
    CodeEnd(reader, contact.a);
    CodeEnd(reader, contact.b);
    for (Vector3* v : {&contact.p_W, &contact.normal_W, &contact.force_W}) {
      for (double& x : *v) {
        reader.Finite(value);
        x = value;
      }
    }
  });
  return reader.finished() && std::ranges::all_of(sensed.contacts, [&scene](const Contact& contact) {
           return coopdyn::Fits(contact, scene);
         });
}

std::size_t ActuatorOf(const Scene& scene, std::size_t channel) {
  const auto robot = static_cast<std::size_t>(scene.channels[channel].robot);
  auto index = static_cast<std::size_t>(scene.robots[robot].first_actuator);
  const auto ends_before = [channel](const SceneActuator& actuator) {
    const int end = actuator.first_channel + actuator.channel_count;
    return static_cast<std::size_t>(end) <= channel;
  };
  while (ends_before(scene.actuators[index])) ++index;
  return index;
}

void EncodeDistances(const Frame& frame, std::vector<std::byte>& blob) {
  ByteWriter writer(blob);
  for (std::size_t robot = 0; robot < frame.scene->robots.size(); ++robot) {
    for (const double range_m : Distances(frame, static_cast<int>(robot))) {
      writer.Number(static_cast<float>(range_m));
    }
  }
}

void EncodeTargets(const Frame& frame, std::vector<std::byte>& blob) {
  constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();
  ByteWriter writer(blob);
  const auto targets = static_cast<int>(frame.scene->targets.size());
  if (targets == 0) return;
  for (std::size_t robot = 0; robot < frame.scene->robots.size(); ++robot) {
    const std::vector<Sighting> seen = SeenTargets(frame, static_cast<int>(robot));
    auto next = seen.begin();
    for (int target = 0; target < targets; ++target) {
      const bool sees = next != seen.end() && next->index == target;
      writer.Number(sees ? static_cast<float>(next->distance_m) : kUnseen);
      writer.Number(sees ? static_cast<float>(next->bearing_rad) : kUnseen);
      if (sees) ++next;
    }
  }
}

bool DecodeFloats(std::span<const std::byte> blob, std::vector<float>& values) {
  values.assign(blob.size() % sizeof(float) == 0 ? blob.size() / sizeof(float) : 0, 0);
  ByteReader reader(blob);
  for (float& value : values) reader.Number(value);
  return reader.finished();
}

void EncodeScores(std::span<const Score> scores, std::vector<std::byte>& blob) {
  ByteWriter writer(blob);
  for (const Score& score : scores) {
    writer.Number(score.value);
    writer.Bool(score.met);
  }
}

bool DecodeScores(std::span<const std::byte> blob, std::vector<Score>& scores) {
  constexpr std::size_t kBytes = 8 + 1;
  scores.assign(blob.size() % kBytes == 0 ? blob.size() / kBytes : 0, {});
  ByteReader reader(blob);
  for (Score& score : scores) {
    reader.Number(score.value);
    reader.Bool(score.met);
  }
  return reader.finished();
}

}  // namespace coopdyn
