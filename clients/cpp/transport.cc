// SPDX-License-Identifier: MIT
// Teams of two robots carry bars to the targets, past obstacles: client_transport [team1 team2 ...]
//
// The first team goes to the scenario's first target, the second to the second. Leader and helper follow
// attractor dynamics (Bicho, Louro, Soares, Erlhagen); docs/teams.md has the equations, transport_dynamics.h
// the algorithm and its numbers, which are the same in all languages.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "clients/plugin/samples/transport_dynamics.h"

namespace {

namespace client = coopdyn::client;
namespace transport = coopdyn::transport;

constexpr double kSettle_s = 2;       // for the helpers after the leaders have arrived
constexpr double kTimeLimit_s = 180;  // simulated
constexpr std::string_view kLeader = "_leader";

transport::Ranges RangesOf(const std::vector<double>& distances, const client::Geometry& geometry) {
  return {std::min(distances.size(), geometry.bearing.size()), distances.data(), geometry.bearing.data(),
          geometry.opening.data()};
}

transport::Load LoadOf(const client::Reading& reading) {
  return {reading.support->x, reading.support->y, reading.support->angle};
}

/// Leader and helper of a team, and the number of their target.
class Team {
 public:
  Team(client::Simulation& sim, std::string name, std::size_t number)
      : name_(std::move(name)),
        number_(number),
        front_(sim.robot(name_ + std::string(kLeader))),
        back_(sim.robot(name_ + "_helper")),
        front_geometry_(front_.get_geometry()),
        back_geometry_(back_.get_geometry()) {}

  const std::string& name() const { return name_; }
  /// Time when the leader arrived at the target.
  std::optional<double> arrived() const { return arrived_; }

  void Drive(double dt) {
    client::Reading s = front_.sense();
    const client::Target& target = s.targets.at(number_ % s.targets.size());
    const transport::Velocity lead =
        leader_.Step(target.distance, target.bearing, RangesOf(s.distances, front_geometry_), LoadOf(s), dt);
    front_.set_velocity(lead.forward, lead.turn);
    if (target.distance < transport::kReached && !arrived_) {
      arrived_ = s.time;
      std::printf("%s arrived: %.2f %.2f at t = %.2f s\n", name_.c_str(), s.pose->x, s.pose->y, s.time);
    }
    s = back_.sense();
    const transport::Velocity help = helper_.Step(RangesOf(s.distances, back_geometry_), LoadOf(s), dt);
    back_.set_velocity(help.forward, help.turn);
  }

 private:
  std::string name_;
  std::size_t number_;
  client::Robot front_, back_;
  client::Geometry front_geometry_, back_geometry_;
  transport::Leader leader_;
  transport::Helper helper_;
  std::optional<double> arrived_;
};

std::vector<std::string> TeamsOf(client::Simulation& sim) {
  std::vector<std::string> names;
  for (const std::string& name : sim.robots()) {
    if (name.ends_with(kLeader)) names.push_back(name.substr(0, name.size() - kLeader.size()));
  }
  return names;
}

int Run(std::vector<std::string> names) {
  client::Simulation sim = client::connect();
  if (names.empty()) names = TeamsOf(sim);
  if (names.empty()) {
    std::printf("there is no team here; run the daemon with: coopdyn serve transport\n");
    return 1;
  }
  std::vector<Team> teams;
  for (const std::string& name : names) teams.emplace_back(sim, name, teams.size());
  const double dt = sim.dt(), start = sim.time();
  const auto has_settled = [&](const Team& team) {
    return team.arrived() && sim.time() - *team.arrived() > kSettle_s;
  };
  while (sim.time() - start < kTimeLimit_s && !std::all_of(teams.begin(), teams.end(), has_settled)) {
    for (Team& team : teams) team.Drive(dt);
    sim.step();
  }
  int late = 0;
  for (const Team& team : teams) {
    if (team.arrived()) continue;
    ++late;
    std::printf("%s did not arrive in %g s\n", team.name().c_str(), kTimeLimit_s);
  }
  sim.close();
  return late > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try { return Run({argv + 1, argv + argc}); } catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
