// SPDX-License-Identifier: MIT
#include "server/yarp/board_stream.h"

#include <cstdint>
#include <functional>

#include "server/yarp/struct_writer.h"

namespace coopdyn {
void BoardSampler::AppendState(const BoardState& state, YarpDialect dialect, std::string& out) {
  const bool is4 = dialect == YarpDialect::k4;
  const std::size_t count = state.joints.size();
  const double elapsed_s = state.time_s - time_s_;
  std::vector<double> accelerations(count, 0.0);
  for (std::size_t i = 0; i < count && velocities_.size() == count && elapsed_s > 0; ++i)
    accelerations[i] = (state.joints[i].velocity - velocities_[i]) / elapsed_s;
  velocities_.resize(count);
  for (std::size_t i = 0; i < count; ++i) velocities_[i] = state.joints[i].velocity;
  time_s_ = state.time_s;

  YarpStructWriter write(dialect, out);
  const auto append = [&](const std::vector<double>& values, bool valid) {
    write.Doubles(values);
    write.Bool(valid);
  };
  const auto append_words = [&](const std::function<std::string_view(const BoardJoint&)>& word) {
    std::vector<std::int32_t> codes;
    for (const BoardJoint& joint : state.joints) codes.push_back(VocabCode(word(joint)));
    write.Ints(codes);
    write.Bool(true);
  };
  const std::vector<double> none(count);
  const auto append_floats = [&] {
    write.Floats(none);
    write.Bool(false);
  };
  std::vector<double> positions(count), efforts(count);
  for (std::size_t i = 0; i < count; ++i) {
    positions[i] = state.joints[i].position;
    efforts[i] = state.joints[i].effort;
  }
  write.Struct(is4 ? 24 : 22);
  for (int motor = 0; motor < 2; ++motor) {  // joints, then motors, which move like the joints
    append(positions, true);
    append(velocities_, true);
    append(accelerations, true);
  }
  append(efforts, true);
  if (is4) {
    append_floats();  // duty cycles
  } else {
    append(none, false);
  }
  append(none, false);  // currents
  append_words([](const BoardJoint& joint) { return BoardModeWord(joint.mode); });
  append_words([](const BoardJoint& joint) { return std::string_view(joint.stiff ? "stif" : "comp"); });
  if (is4) append_floats();  // temperatures
}

Bottle BoardPositions(const BoardState& state) {
  Bottle positions;
  for (const BoardJoint& joint : state.joints) positions.emplace_back(joint.position);
  return positions;
}

}  // namespace coopdyn
