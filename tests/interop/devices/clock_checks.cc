// SPDX-License-Identifier: MIT
#include <yarp/os/Bytes.h>
#include <yarp/os/ConnectionReader.h>
#include <yarp/os/Network.h>
#include <yarp/os/PeriodicThread.h>
#include <yarp/os/Port.h>
#include <yarp/os/PortReader.h>
#include <yarp/os/SystemClock.h>
#include <yarp/os/Time.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "board.h"
#include "sections.h"

namespace coopdyn {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr double kRounding_s = 1e-9;
constexpr double kCatchUp_s = 1;

/// Records the times of its runs, for N simulated seconds, and then until it is on time.
class Ticks : public yarp::os::PeriodicThread {
 public:
  Ticks(double seconds, yarp::os::PeriodicThreadClock clock)
      : PeriodicThread(kPeriod_s, clock), seconds_(seconds) {
    times_.reserve(static_cast<std::size_t>(1.1 * seconds / kPeriod_s) + 10);
  }

  void run() override {
    if (ended_) return;
    const double now_s = yarp::os::Time::now();
    times_.push_back(now_s);
    const double passed_s = now_s - times_.front(), due_s = passed_s - seconds_;
    ended_ = due_s >= -kRounding_s && (Late() <= kPeriod_s + kRounding_s || due_s > kCatchUp_s);
  }

  /// Delay of the last run relative to whole periods since the first run, s.
  double Late() const {
    return times_.back() - times_.front() - kPeriod_s * static_cast<double>(times_.size() - 1);
  }

  bool ended() const { return ended_; }
  /// Valid once the thread has ended.
  const std::vector<double>& times() const { return times_; }

 private:
  const double seconds_;
  std::vector<double> times_;
  std::atomic<bool> ended_ = false;
};

struct Gaps {
  double least_s = INFINITY, most_s = 0;
  int longer = 0;  // than a period
};

Gaps GapsOf(const std::vector<double>& times) {
  Gaps gaps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double gap_s = times[i] - times[i - 1];
    gaps.least_s = std::min(gaps.least_s, gap_s);
    gaps.most_s = std::max(gaps.most_s, gap_s);
    if (gap_s > kPeriod_s + kRounding_s) ++gaps.longer;
  }
  return gaps;
}

/// Runs the thread to its end and reports its measurements.
void Run(Checks& checks, const std::string& name, Ticks& ticks) {
  const double began_s = yarp::os::SystemClock::nowSystem();
  ticks.start();
  const bool ended = WaitFor([&] { return ticks.ended(); }, 600);
  const double took_s = yarp::os::SystemClock::nowSystem() - began_s;
  if (!ended) AskSimulation("set_mode realtime");  // else it waits for time, which waits for this program
  ticks.stop();
  const std::vector<double>& times = ticks.times();
  const Gaps gaps = GapsOf(times);
  checks.That(name + ": it runs to its end", ended && times.size() > 1,
              std::to_string(times.size()) + " periods");
  if (times.size() < 2) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "%zu periods of 1 ms from %.6f to %.6f s, late at the end %.6f ms; gaps %.6f to %.6f ms, %d "
                "longer than "
                "a period; %.2f s of the wall clock",
                times.size() - 1, times.front(), times.back(), ticks.Late() * 1e3, gaps.least_s * 1e3,
                gaps.most_s * 1e3, gaps.longer, took_s);
  Checks::Note(text);
}

/// By the absolute clock it catches up on late periods: none is lost, none runs twice.
void CheckExact(Checks& checks, const std::string& name, const Ticks& ticks) {
  checks.Near(name + ": as many periods as steps", ticks.Late(), 0, kPeriod_s + kRounding_s);
}

/// It may be late, but never runs more often than its period; and time never goes back.
void CheckNotTooOften(Checks& checks, const std::string& name, const Ticks& ticks, double seconds) {
  const double most = seconds / kPeriod_s + 1.5;
  const bool good =
      static_cast<double>(ticks.times().size()) - 1 <= most && GapsOf(ticks.times()).least_s >= 0;
  checks.That(name + ": not too often", good, std::to_string(ticks.times().size() - 1) + " periods");
}

/// A step as long as the period, as time advances by whole steps.
bool Prepare(Checks& checks, bool on_the_clock) {
  const bool ready =
      checks.That("the thread runs on the simulated clock", on_the_clock, "set YARP_CLOCK=/clock") &&
      checks.That("steps of 1 ms", AskSimulation("set_step 0.001").get(0).asString() != "fail");
  return ready && checks.Near("Time::now() is simulated time", yarp::os::Time::now(), SimulatedTime(), 0.5);
}

/// Reads a port without a buffer: acknowledges a sample when `each` returns.
class Samples : public yarp::os::PortReader {
 public:
  explicit Samples(std::function<void()> each) : each_(std::move(each)) {}

  bool read(yarp::os::ConnectionReader& connection) override {
    yarp::os::Bottle sample;
    if (!sample.read(connection)) return false;
    const yarp::os::Bytes bytes = connection.readEnvelope();
    const yarp::os::Bottle envelope(std::string(bytes.get(), bytes.length()));  // number, time
    const double time_s = envelope.get(1).asFloat64();
    if (count_ > 0 && std::abs(time_s - last_s_ - kPeriod_s) > kRounding_s) ++gaps_;
    last_s_ = time_s;
    ++count_;
    each_();
    return true;
  }
  int count() const { return count_; }
  /// Steps missed or seen twice.
  int gaps() const { return gaps_; }
  double last_s() const { return last_s_; }

 private:
  const std::function<void()> each_;
  std::atomic<int> count_ = 0, gaps_ = 0;
  std::atomic<double> last_s_ = 0;
};

/// Connects the reader, which calls `each`, to the encoders of an arm.
bool Connect(yarp::os::Port& reader, Samples& samples, const std::string& name) {
  reader.setReader(samples);
  return reader.open(name) && yarp::os::Network::connect("/arm1/arm/state:o", name, "tcp");
}

}  // namespace

void CheckClock(Checks& checks, double seconds) {
  if (!Prepare(checks, !yarp::os::Time::isSystemClock())) return;
  using yarp::os::PeriodicThreadClock;
  for (const char* const speed : {"0.5", "1", "4"}) {
    AskSimulation("set_speed " + std::string(speed));
    for (const auto clock : {PeriodicThreadClock::Relative, PeriodicThreadClock::Absolute}) {
      const bool relative = clock == PeriodicThreadClock::Relative;
      const std::string name = "speed " + std::string(speed) + (relative ? ", relative" : ", absolute");
      Ticks ticks(seconds, clock);
      Run(checks, name, ticks);
      // A busy machine makes it late. By the relative clock it then skips periods.
      if (relative)
        CheckNotTooOften(checks, name, ticks, ticks.times().back() - ticks.times().front());
      else
        CheckExact(checks, name, ticks);
    }
  }
  AskSimulation("set_speed 1");
  AskSimulation("set_step 0.01");
}

void CheckLockstep(Checks& checks, double seconds) {
  yarp::os::Time::useNetworkClock("/clock", "/devices/clock:i");
  WaitFor([] { return yarp::os::Time::isValid(); });
  if (!Prepare(checks, yarp::os::Time::isNetworkClock())) return;
  Board board;
  if (!checks.That("open", board.Open("/arm1/arm", "/devices/lockstep"))) return;
  board.SetModes("vel");
  checks.That("lockstep", AskSimulation("set_mode lockstep").get(0).asString() != "fail");
  const int steps = static_cast<int>(seconds / kPeriod_s);

  // Each step waits until this program has received the time and the arm's encoders, not until its thread has
  // run.
  for (const std::string speed : {"1", "0"}) {
    AskSimulation("set_speed " + speed);
    const std::string name = speed == "1" ? "lockstep at speed 1" : "lockstep without limit";
    Samples samples([] {});
    yarp::os::Port reader;
    checks.That(name + ": a reader", Connect(reader, samples, "/devices/encoders:i"));
    Ticks ticks(seconds, yarp::os::PeriodicThreadClock::Absolute);
    Run(checks, name, ticks);
    if (speed == "1")
      CheckExact(checks, name, ticks);
    else  // the world may be faster than the thread
      CheckNotTooOften(checks, name, ticks, ticks.times().back() - ticks.times().front());
    checks.That(name + ": each step's sample comes once", samples.count() >= steps && samples.gaps() == 0,
                std::to_string(samples.gaps()) + " gaps in " + std::to_string(samples.count()));
    reader.close();
  }

  // A loop that reads and drives, with a command for each sample. A PeriodicThread cannot do this: if a step
  // ends between its two readings of the clock, it waits for the step after the next, which waits for its
  // command.
  checks.That("the arm takes part", AskSimulation("set_participants arm1").get(0).asString() != "fail");
  const double from_s = SimulatedTime(), began_s = yarp::os::SystemClock::nowSystem();
  int sent = 0;
  Samples samples([&] { board.velocity->velocityMove(0, 20 * std::sin(kPeriod_s * ++sent)); });
  yarp::os::Port reader;
  checks.That("lockstep, driving: a reader", Connect(reader, samples, "/devices/driving:i"));
  checks.That("lockstep, driving: it runs to its end", WaitFor([&] { return samples.count() > steps; }, 600),
              std::to_string(samples.count()) + " samples");
  Checks::Note(std::to_string(samples.count() - 1) + " steps from " + Text(from_s) + " to " +
               Text(samples.last_s()) + " s, a command for each; " +
               Text(yarp::os::SystemClock::nowSystem() - began_s) + " s of the wall clock");
  checks.That("lockstep, driving: each step's sample comes once", samples.gaps() == 0,
              std::to_string(samples.gaps()));
  AskSimulation("set_mode realtime");
  reader.close();
  AskSimulation("set_participants");
  AskSimulation("set_step 0.01");
  AskSimulation("set_speed 1");
  checks.That("close", board.Close());
}

}  // namespace coopdyn
