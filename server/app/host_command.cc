// SPDX-License-Identifier: MIT
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <future>
#include <iterator>
#include <memory>
#include <set>
#include <utility>

#include "server/app/addresses.h"
#include "server/app/class_files.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/app/python_programs.h"
#include "server/app/shutdown.h"
#include "server/host/class_pages.h"
#include "server/host/class_room.h"
#include "server/host/front_door.h"
#include "server/model/readers.h"
#include "server/net/io_thread.h"
#include "server/record/run_header.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;

struct HostOptions {
  std::vector<std::string> lessons;
  std::string class_file;  // empty: that of the folder, or `students`
  int students = 0;        // numbered; 0: none
  std::string folder = "class";
  int port = 10000;
  std::vector<std::string> hosts;
  std::string advertise;
  double idle_min = 15;
  std::uint64_t memory_mib = 1024, disk_mib = 1024;
  std::vector<std::string> scenario_folders;
  int seat_ports = 0;  // the first; 0: seats have none
  bool no_render = false;
  std::string log_level = "info";
};

/// Only one host may use a folder. Held until it is destroyed; none: `error` says why.
UniqueFd LockFolder(const fs::path& folder, std::string& error) {
  UniqueFd lock(::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock) {
    error = "the folder " + folder.string() + " cannot be used: " + std::strerror(errno);
  } else if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    error = "another host uses the folder " + folder.string() + ": write another --folder";
    lock.Reset();
  }
  return lock;
}

/// The class list: the file that is named, that of the folder, or numbered students. Nothing: it has been
/// said why.
std::optional<Roll> ChooseRoll(const HostOptions& options) {
  const fs::path kept = RollFile(options.folder);
  const fs::path taken_file = fs::path(options.folder) / "list";  // the hash of the list that was taken in
  const UniqueFd lock = LockRoll(options.folder);
  Diagnostics diagnostics;
  std::optional<Roll> roll;
  std::error_code code;  // a pipe can be read only once
  const std::string hash =
      fs::is_regular_file(options.class_file, code) ? FileHash(options.class_file) : std::string();
  if (!options.class_file.empty()) {
    Diagnostics none;
    const std::optional<Roll> before = fs::exists(kept) ? LoadRoll(kept, none) : std::nullopt;
    // The same list again does not undo what `coopdyn seat` has changed since.
    std::string taken;
    std::ifstream(taken_file) >> taken;
    roll = before && !hash.empty() && hash == taken
               ? before
               : LoadRoll(options.class_file, diagnostics, before.value_or(Roll()));
  } else if (options.students > 0 && !fs::exists(kept)) {
    roll = NumberedRoll(options.students, SystemRandom());
  } else if (fs::exists(kept)) {
    roll = LoadRoll(kept, diagnostics);
    for (int n = static_cast<int>(roll ? roll->entries().size() : 0) + 1; roll && n <= options.students; ++n)
      roll->Add({.seat = fmt::format("student{}", n), .name = fmt::format("Student {}", n)}, SystemRandom());
  } else {
    PrintError(
        "coopdyn: who is in the class? Write --students 30, or --class FILE.csv with the columns "
        "name,pin,group\n");
    return std::nullopt;
  }
  PrintErrorLines(diagnostics.ToString());
  if (!roll) return std::nullopt;
  std::ifstream file(kept);
  const bool is_kept = std::string{std::istreambuf_iterator<char>(file), {}} == roll->ToCsv();
  // What is there need not be written: the disk may be full.
  if (const std::string error = is_kept ? "" : SaveRoll(kept, *roll); !error.empty()) {
    PrintError("coopdyn: {}\n", error);
    return std::nullopt;
  }
  if (!hash.empty()) std::ofstream(taken_file) << hash << '\n';
  return roll;
}

/// Each seat's daemon listens in its folder, and the kernel limits such paths. An error text.
std::string DoorProblem(const fs::path& folder, const Roll& roll) {
  for (const RollEntry& entry : roll.entries()) {
    const std::string door = (folder / "seats" / entry.seat / "door").string();
    if (door.size() >= sizeof(sockaddr_un::sun_path))
      return fmt::format("the path {} is too long for a socket: write a --folder that is {} bytes shorter",
                         door, door.size() + 1 - sizeof(sockaddr_un::sun_path));
  }
  return {};
}

/// False: a scenario has mistakes, which have been said.
bool CheckLessons(const HostOptions& options) {
  for (const std::string& lesson : options.lessons) {
    Diagnostics diagnostics;
    RobotLibrary robots(DataPath(options.scenario_folders));
    if (LoadScenario(lesson, robots, diagnostics) != nullptr && !diagnostics.has_errors()) continue;
    PrintErrorLines(diagnostics.ToString());
    return false;
  }
  return true;
}

/// The class list may be changed while the host runs: by `coopdyn seat`, or by an editor.
class RollWatch {
 public:
  RollWatch(fs::path folder, Roll roll)
      : folder_(std::move(folder)), roll_(std::move(roll)), last_(Stamp()), seen_(last_) {}

  /// The new list, if there is one that has not changed since the last look: an editor may write it in
  /// pieces. Mistakes are logged, and the old one stays. PINs that are not in it are those of before, or made
  /// and written.
  std::optional<Roll> Look(const Logger& logger) {
    const auto before = std::exchange(last_, Stamp());
    if (last_ == seen_ || last_ != before) return std::nullopt;
    const UniqueFd lock = LockRoll(folder_);
    seen_ = last_;
    Diagnostics diagnostics, again;
    std::optional<Roll> roll = LoadRoll(file_, diagnostics, roll_);
    if (!roll) {
      logger->error("the class list stays as it was: {}", diagnostics.ToString());
      return roll;
    }
    roll_ = *roll;
    const std::optional<Roll> written = LoadRoll(file_, again);
    if (written && written->ToCsv() == roll->ToCsv()) return roll;
    if (std::string error = SaveRoll(file_, *roll); !error.empty()) logger->error("{}", error);
    seen_ = last_ = Stamp();
    return roll;
  }

 private:
  std::pair<fs::file_time_type, std::uintmax_t> Stamp() const {
    std::error_code code;
    return {fs::last_write_time(file_, code), fs::file_size(file_, code)};
  }

  const fs::path folder_, file_ = RollFile(folder_);
  Roll roll_;
  std::pair<fs::file_time_type, std::uintmax_t> last_, seen_;
};

int RunHost(HostOptions options) {
  std::error_code code;
  if (fs::create_directories(options.folder, code))
    fs::permissions(options.folder, fs::perms::owner_all, code);
  options.folder = fs::absolute(options.folder).lexically_normal();
  if (code) {
    PrintError("coopdyn: --folder {}: {}\n", options.folder, code.message());
    return kExitErrors;
  }
  std::string problem;
  const UniqueFd lock = LockFolder(options.folder, problem);
  if (!lock) {
    PrintError("coopdyn: {}\n", problem);
    return kExitErrors;
  }
  if (options.lessons.empty()) options.lessons = {"classroom"};
  for (std::string& lesson : options.lessons) {
    if (fs::exists(lesson, code) && fs::is_regular_file(lesson, code)) lesson = fs::absolute(lesson);
  }
  if (!CheckLessons(options)) return kExitErrors;
  std::optional<Roll> roll = ChooseRoll(options);
  if (!roll) return kExitErrors;
  RollWatch watch(options.folder, *roll);
  problem = DoorProblem(options.folder, *roll);
  const std::string token = problem.empty() ? TeacherToken(options.folder, problem) : std::string();
  if (!problem.empty()) {
    PrintError("coopdyn: {}\n", problem);
    return kExitErrors;
  }

  Shutdown shutdown;
  const LogBackend log(options.log_level, "");
  const SteadyClock clock;
  NetServices net(log.logger(), clock);
  WrongTokens wrong(log.logger());
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) == 0) {
    files.rlim_cur = files.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &files);
  }

  IoThread io("host", log.logger());
  const std::vector<std::string> addresses = Addresses(options.hosts);
  std::string host = options.advertise;
  if (host.empty()) host = options.hosts.empty() ? "127.0.0.1" : options.hosts.front();
  if (host == "0.0.0.0" || host == "::") host = LanAddress().empty() ? "127.0.0.1" : LanAddress();

  ClassOptions what{.folder = options.folder, .lessons = options.lessons};
  what.plan.program = fs::read_symlink("/proc/self/exe", code);
  what.plan.limits.memory_bytes = options.memory_mib << 20;
  what.plan.limits.disk_bytes = options.disk_mib << 20;
  for (const std::string& folder : options.scenario_folders)
    what.plan.more_arguments.insert(what.plan.more_arguments.end(),
                                    {"--scenarios", fs::absolute(folder).string()});
  what.programs.python = PythonProgram();
  if (const fs::path found = FolderWithClient("programs"); !found.empty())
    what.programs.clients = fs::absolute(found) / "clients";
  what.plan.port = options.seat_ports;
  if (options.seat_ports != 0) {
    for (const std::string& address : options.hosts)
      what.plan.more_arguments.insert(what.plan.more_arguments.end(), {"--host", address});
  }
  if (!options.advertise.empty())  // pages are addressed by that name
    what.plan.more_arguments.insert(what.plan.more_arguments.end(), {"--advertise", options.advertise});
  if (options.no_render) what.plan.more_arguments.emplace_back("--no-render");
  what.idle = static_cast<Nanoseconds>(options.idle_min * 60 * 1e9);

  ClassRoom room(io.context(), std::move(what), std::move(*roll), clock, log.logger());
  SeatGuard guard(room, clock, wrong);
  FrontDoor door(io.context(), room, guard, net);
  std::vector<std::string> names = options.hosts;
  if (!options.advertise.empty()) names.push_back(options.advertise);
  std::array<char, 256> own_name{};
  if (::gethostname(own_name.data(), own_name.size() - 1) == 0) names.emplace_back(own_name.data());
  ClassPages pages(io.context(), room, guard, token, names, wrong, clock, net);
  for (const std::string& error : {door.Listen(addresses, options.port),
                                   pages.Listen(addresses, options.port == 0 ? 0 : options.port + 1)}) {
    if (error.empty()) continue;
    PrintError("coopdyn: {}\n", WithAdvice(error, "--port"));
    io.Stop();
    return kExitErrors;
  }
  const std::string url = fmt::format("http://{}:{}/", Bracketed(host), pages.port());
  room.set_names_port(door.port());
  io.Call([&room, &url] { room.Open(url); });
  PrintError(
      "wall:     {}wall/   (token {})\nstudents: {}\nsheet:    {}wall/class/sheet   (PINs are in {})\n", url,
      token, url, url, RollFile(options.folder).string());
  Print("ready names={}:{} http={} seats={}\n", Bracketed(host), door.port(), url,
        room.roll().entries().size());

  while (shutdown.Wait(kNanosecondsPerSecond) != Shutdown::Wake::kEnd) {
    if (std::optional<Roll> changed = watch.Look(log.logger()))
      io.Call([&room, &changed] { room.SetRoll(std::move(*changed)); });
  }
  std::promise<void> aside;
  io.Call([&room, &aside] { room.PutAllAside([&aside] { aside.set_value(); }); });
  aside.get_future().wait_for(std::chrono::seconds(30));
  io.Stop();
  return kExitOk;
}

/// False, and it has been said: there is no class in FOLDER.
bool HasClass(const std::string& folder) {
  std::error_code code;
  if (fs::exists(fs::symlink_status(RollFile(folder), code))) return true;
  PrintError("coopdyn: there is no class in the folder {}: write the --folder of its coopdyn host\n", folder);
  return false;
}

/// Changes the list of FOLDER and says what it has become.
int ChangeRoll(const std::string& folder, const std::function<std::string(Roll&)>& change) {
  if (!HasClass(folder)) return kExitErrors;
  const UniqueFd lock = LockRoll(folder);
  Diagnostics diagnostics;
  std::optional<Roll> roll = LoadRoll(RollFile(folder), diagnostics);
  if (!roll) {
    PrintErrorLines(diagnostics.ToString());
    return kExitErrors;
  }
  std::set<std::string> before;
  for (const RollEntry& entry : roll->entries()) before.insert(entry.seat + " " + entry.pin);
  std::string error = change(*roll);
  if (error.empty()) error = SaveRoll(RollFile(folder), *roll);
  if (!error.empty()) {
    PrintError("coopdyn: {}\n", error);
    return kExitErrors;
  }
  for (const RollEntry& entry : roll->entries()) {
    if (!before.contains(entry.seat + " " + entry.pin))
      Print("{} {} {}\n", entry.seat, entry.pin, entry.name);
  }
  return kExitOk;
}

void AddSeatCommand(CLI::App& app, Chosen& chosen) {
  CLI::App* seat = app.add_subcommand("seat", "Change the list of a class, also while its host runs");
  seat->require_subcommand(1);
  seat->footer("Example: coopdyn seat add \"Ana Lima\" --group 2");
  const auto folder = std::make_shared<std::string>("class");
  const auto entry = std::make_shared<RollEntry>();
  const auto add_folder = [&folder](CLI::App* sub) {
    sub->add_option("--folder", *folder, "The folder of the class")->capture_default_str();
  };
  CLI::App* add = seat->add_subcommand("add", "A student comes");
  add->add_option("name", entry->name, "As the wall shows it")->required();
  add->add_option("--seat", entry->seat, "Name of the seat (default: made of the name)");
  add->add_option("--pin", entry->pin, "PIN (default: one is made)");
  add->add_option("--group", entry->group, "Group");
  add->callback([=, &chosen] {
    chosen = [=] {
      return ChangeRoll(*folder, [=](Roll& roll) { return roll.Add(*entry, SystemRandom()); });
    };
  });
  CLI::App* remove = seat->add_subcommand("remove", "A student goes; the folder of the seat stays");
  remove->add_option("seat", entry->seat, "Name of the seat")->required();
  remove->callback([=, &chosen] {
    chosen = [=] {
      return ChangeRoll(*folder, [=](Roll& roll) {
        if (roll.Remove(entry->seat)) return std::string();
        const std::string nearest = roll.Nearest(entry->seat);
        return "there is no seat " + entry->seat + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
      });
    };
  });
  CLI::App* pin = seat->add_subcommand("pin", "Another PIN and link for a seat; the old ones no longer work");
  pin->add_option("seat", entry->seat, "Name of the seat")->required();
  pin->add_option("pin", entry->pin, "PIN (default: one is made)");
  pin->callback([=, &chosen] {
    chosen = [=] {
      return ChangeRoll(*folder,
                        [=](Roll& roll) { return roll.SetPin(entry->seat, entry->pin, SystemRandom()); });
    };
  });
  CLI::App* list = seat->add_subcommand("list", "Seats, PINs, names and groups");
  list->callback([=, &chosen] {
    chosen = [=] {
      if (!HasClass(*folder)) return kExitErrors;
      Diagnostics diagnostics;
      const std::optional<Roll> roll = LoadRoll(RollFile(*folder), diagnostics);
      PrintErrorLines(diagnostics.ToString());
      if (!roll) return kExitErrors;
      for (const RollEntry& one : roll->entries())
        Print("{:16} {:8} {}{}\n", one.seat, one.pin, one.name,
              one.group.empty() ? "" : " (" + one.group + ")");
      return kExitOk;
    };
  });
  for (CLI::App* sub : {add, remove, pin, list}) add_folder(sub);
}

}  // namespace

void AddHost(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<HostOptions>();
  HostOptions& host = *given;
  CLI::App* sub = app.add_subcommand("host", "A class: a daemon for each student, one page for the teacher");
  sub->footer(
      "Example: coopdyn host classroom --students 30 --host 0.0.0.0\n"
      "Who has a seat already keeps PIN and link: they are in FOLDER/class.csv.");
  sub->add_option("lessons", host.lessons, "Scenarios, in the order of the lesson (default: classroom)");
  sub->add_option("--students", host.students, "That number of seats, student1 and so on")
      ->check(WholeIn(1, Roll::kMaxSeats));
  sub->add_option("--class", host.class_file, "A list of students: CSV with the columns name, pin, group");
  sub->add_option("--folder", host.folder, "What the class keeps: list, token, a folder for each seat")
      ->capture_default_str();
  sub->add_option("--port", host.port, "Programs on P, pages on P+1; 0: any free ports")
      ->check(WholeIn(0, 65000))
      ->capture_default_str();
  sub->add_option("--host", host.hosts,
                  "Address to listen at (default: this machine only); 0.0.0.0: everybody");
  sub->add_option("--advertise", host.advertise, "Address of this machine on the sheet and in links");
  sub->add_option("--idle", host.idle_min,
                  "Minutes without anything after which a seat is put aside; 0: never")
      ->check(NumberIn(0, 1e6))
      ->capture_default_str();
  sub->add_option("--memory", host.memory_mib, "MiB that each seat may use")
      ->check(WholeIn(64, 1 << 20))
      ->capture_default_str();
  sub->add_option("--disk", host.disk_mib, "MiB of recordings that each seat may keep")
      ->check(WholeIn(16, 1 << 20))
      ->capture_default_str();
  sub->add_option("--scenarios", host.scenario_folders, "A folder with scenarios, worlds and robots");
  sub->add_option(
         "--seat-ports", host.seat_ports,
         "Give seats ports of their own, for YARP and YARS: 100 each from this one on. Only machines from "
         "which the PIN was shown may use them")
      ->check(WholeIn(1024, 60000));
  sub->add_flag("--no-render", host.no_render, "No pictures of cameras; pages draw by themselves");
  sub->add_option("--log-level", host.log_level, "debug, info, warning, error or off")
      ->check(OneOf({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  sub->callback([given, &chosen] { chosen = [given] { return RunHost(*given); }; });
  AddSeatCommand(app, chosen);
}

}  // namespace coopdyn
