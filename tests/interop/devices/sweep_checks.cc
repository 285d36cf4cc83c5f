// SPDX-License-Identifier: MIT
#include <yarp/os/Network.h>
#include <yarp/os/RFModule.h>
#include <yarp/os/ResourceFinder.h>
#include <yarp/os/Time.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "board.h"
#include "sections.h"

namespace coopdyn {
namespace {

/// Moves a joint back and forth. Its options name the robot; it does not know that it is simulated.
class Sweep : public yarp::os::RFModule {
 public:
  bool configure(yarp::os::ResourceFinder& options) override {
    joint_ = options.check("joint", yarp::os::Value(0)).asInt32();
    ends_[0] = options.check("from", yarp::os::Value(-20.0)).asFloat64();
    ends_[1] = options.check("to", yarp::os::Value(20.0)).asFloat64();
    ways_left_ = options.check("ways", yarp::os::Value(4)).asInt32();
    const double speed = options.check("speed", yarp::os::Value(60.0)).asFloat64();
    const std::string name = options.check("name", yarp::os::Value("/sweep")).asString();
    if (!board_.Open(options.find("robot").asString(), name)) return false;
    std::vector<double> speeds = board_.WaySpeeds().value_or(std::vector<double>(board_.axes(), speed));
    speeds[joint_] = speed;
    return board_.SetMode(joint_, "pos") && board_.SetWaySpeeds(speeds) && Go();
  }

  double getPeriod() override { return 0.02; }

  bool updateModule() override {
    const double position = board_.Position(joint_);
    least_ = std::min(least_, position);
    most_ = std::max(most_, position);
    if (!board_.Done(joint_).value_or(false)) return true;
    if (--ways_left_ <= 0) return false;
    end_ = 1 - end_;
    return Go();
  }

  bool close() override { return board_.Close(); }

  int ways_left() const { return ways_left_; }
  double least() const { return least_; }
  double most() const { return most_; }

 private:
  bool Go() { return bool(board_.position->positionMove(joint_, ends_[end_])); }

  Board board_;
  int joint_ = 0, end_ = 1, ways_left_ = 0;
  double ends_[2] = {0, 0}, least_ = 1e9, most_ = -1e9;
};

/// The options as on a command line.
void Configure(yarp::os::ResourceFinder& options, std::vector<std::string> words) {
  words.insert(words.begin(), "sweep");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  options.configure(static_cast<int>(pointers.size()), pointers.data());
}

}  // namespace

void CheckSweep(Checks& checks) {
  Checks::Note(yarp::os::Time::isSystemClock() ? "on the system's clock" : "on the simulated clock");
  yarp::os::ResourceFinder options[2];
  Configure(options[0], {"--robot", "/arm1/arm", "--name", "/devices/sweep1", "--from", "-25", "--to", "25"});
  Configure(options[1], {"--robot", "/arm2/arm", "--name", "/devices/sweep2", "--from", "-10", "--to", "40"});
  Sweep sweeps[2];
  for (int i = 0; i < 2; ++i)
    checks.That("sweep " + std::to_string(i + 1) + ": starts", sweeps[i].runModuleThreaded(options[i]) == 0);
  constexpr double kEnds[2][2] = {{-25, 25}, {-10, 40}};
  for (int i = 0; i < 2; ++i) {
    const std::string name = "sweep " + std::to_string(i + 1);
    checks.That(name + ": all its ways", sweeps[i].joinModule(30) && sweeps[i].ways_left() == 0,
                std::to_string(sweeps[i].ways_left()) + " are left");
    checks.AllNear(name + ": from end to end", std::array{sweeps[i].least(), sweeps[i].most()}, kEnds[i],
                   0.5);
  }
}

}  // namespace coopdyn
