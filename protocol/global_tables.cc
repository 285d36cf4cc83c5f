// SPDX-License-Identifier: MIT
// The command tables of the global modules: /simulation, /world, /swarm, /recorder and /playback.
#include <utility>

#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/spec_parts.h"

namespace coopdyn {
namespace {

std::vector<std::pair<std::string, std::int32_t>> OffOn() {
  return {{"off", 0}, {"on", 1}};
}

}  // namespace

CommandTable SimulationTable() {
  CommandSpec status = Order(command::kGetStatus, "get_status", "Returns the state of the whole simulation.");
  status.reply_text = "JSON";
  status.params = {{.name = "first", .unit = "", .optional = true, .min = 1},
                   {.name = "count", .unit = "", .optional = true, .min = 0}};
  CommandSpec save =
      Order(command::kSaveState, "save", "Saves the present state under a name, to go on from it later.");
  CommandSpec restore =
      Order(command::kRestoreState, "restore", "Goes on from a saved state; `start` is where the run began.");
  for (CommandSpec* spec : {&save, &restore}) {
    spec->text = TextUse::kRest;
    spec->text_name = "NAME";
  }
  save.example = "save before_turn";
  restore.example = "restore before_turn";
  CommandSpec saved = Reading(command::kGetSaved, "get_saved",
                              "Returns the names and times of the saved states.", {Repeated("time", "s")});
  saved.reply_text = "their names, in the same order, separated by spaces";
  CommandSpec clock =
      Reading(command::kGetClock, "get_clock",
              "Returns the simulated time in whole numbers, and the length of a step.", {Value("step", "s")});
  clock.reply_params = {{.name = "seconds", .unit = "s"}, {.name = "nanoseconds", .unit = "ns"}};
  return CommandTable(
      "simulation",
      {
          std::move(status),
          Order(command::kRun, "run", "Lets time go on."),
          Order(command::kPause, "pause", "Stops time."),
          {.id = command::kStep,
           .name = "step",
           .help = "Runs this many steps while paused. The reply comes after the last of them.",
           .params = {{.name = "steps", .unit = "", .min = 1, .max = kMaxSteps}},
           .example = "step 10"},
          {.id = command::kReset,
           .name = "reset",
           .help =
               "Starts again at step 0; with a new seed if one is given, by which [RANDOM] is drawn anew.",
           .params = {{.name = "seed", .unit = "", .optional = true}},
           .example = "reset 7"},
          {.id = command::kSetMode,
           .name = "set_mode",
           .help = "Chooses the time mode.",
           .params = {{.name = "mode", .unit = "", .enums = ModeWords()}},
           .example = "set_mode lockstep"},
          {.id = command::kSetStep,
           .name = "set_step",
           .help = "Sets the length of a step, 0.0005 to 0.1 s.",
           .data = {Value("step", "s")},
           .example = "set_step 0.01"},
          {.id = command::kSetSpeed,
           .name = "set_speed",
           .help = "Sets how fast time goes against the wall clock; 0 or less = no limit.",
           .data = {Value("factor")},
           .example = "set_speed 2"},
          {.id = command::kLoadScenario,
           .name = "load_scenario",
           .help = "Loads a scenario: a name on the search path, or the text of the file.",
           .text = TextUse::kRest,
           .text_name = "SCENARIO",
           .example = "load_scenario corridor"},
          Order(command::kQuit, "quit", "Ends the daemon."),
          Order(command::kStopAll, "stop_all", "Stops every robot."),
          {.id = command::kSetParticipants,
           .name = "set_participants",
           .help = "Chooses the robots that lockstep waits for; without names, as the scenario says.",
           .text = TextUse::kRest,
           .text_name = "ROBOT…",
           .example = "set_participants robot1 robot2",
           .text_optional = true},
          Order(command::kReload, "reload", "Loads the same scenario file again from disk."),
          {.id = command::kReleaseRobot,
           .name = "release_robot",
           .help = "Closes the owner's connection to a robot, or unloads its controller. In text also "
                   "`release ROBOT`.",
           .text = TextUse::kRest,
           .text_name = "ROBOT",
           .example = "release_robot robot1",
           .alias = "release"},
          std::move(save),
          std::move(restore),
          std::move(saved),
          std::move(clock),
          {.id = command::kLog,
           .name = "log",
           .help = "Logs a number under a name: get_status shows it, recordings keep it.",
           .text = TextUse::kFirst,
           .text_name = "NAME",
           .data = {Value("value")},
           .example = "log energy 3.5"},
          {.id = command::kEndRun,
           .name = "end_run",
           .help = "Ends the run, which has reached what it was for. The world stands until a reset; a "
                   "daemon that was "
                   "started for one run (--duration, --steps, --summary, --no-net) ends: exit code 0. The "
                   "text says why.",
           .text = TextUse::kRest,
           .text_name = "WHY",
           .example = "end_run the ball is in the goal",
           .text_optional = true},
      });
}

CommandTable WorldTable() {
  const auto edit = [](std::int32_t id, std::string name, std::string help) {
    CommandSpec spec = Order(id, std::move(name), std::move(help));
    spec.reply_params = {Repeated("id")};
    spec.reply_text = "the names of what was changed, separated by spaces";
    return spec;
  };
  const ValueSpec id{.name = "id", .unit = "", .optional = true, .min = 1};
  CommandSpec insert = edit(command::kInsert, "insert",
                            "Puts things, robots, targets and lights into the world: sections of a scenario; "
                            "in one line bars stand between the lines. [BOX_*] takes the next free number.");
  insert.text = TextUse::kRest;
  insert.text_name = "SECTIONS";
  insert.example = "insert [BOX_*] | type box | size 0.5 0.5 0.5 | position 2 1";
  CommandSpec remove = edit(command::kRemove, "remove", "Takes things out of the world: names, or ids.");
  remove.text = TextUse::kRest;
  remove.text_name = "NAME…";
  remove.text_optional = true;
  remove.params = {{.name = "id", .unit = "", .repeated = true, .min = 1}};
  remove.example = "remove BOX_1";
  CommandSpec pose =
      edit(command::kSetPose, "set_pose",
           "Puts a thing elsewhere, at rest: x and y; then nothing, or z; then nothing, a yaw, or a "
           "quaternion w x y z. What is not said it keeps.");
  pose.text = TextUse::kFirst;
  pose.text_name = "NAME";
  pose.params = {id};
  pose.data = {Value("x", "m"), Value("y", "m"), Repeated("z or turn")};
  pose.example = "set_pose BOX_1 2 1 0.25 0";
  CommandSpec set =
      edit(command::kSetThing, "set", "Changes keys of a thing's section; bars stand between several.");
  set.text = TextUse::kRest;
  set.text_name = "NAME KEY VALUES";
  set.example = "set BOX_1 color red | mass 2kg";
  CommandSpec rename = edit(command::kRename, "rename", "Gives a thing, a robot or a light another name.");
  rename.text = TextUse::kRest;
  rename.text_name = "NAME NEW_NAME";
  rename.example = "rename BOX_1 crate";
  CommandSpec list =
      Order(command::kListWorld, "list", "Returns all that stands in the world, with ids, names and places.");
  list.reply_text = "JSON";
  CommandSpec save =
      Order(command::kSaveWorld, "save",
            "Returns the present world as the text of a scenario, which loads to the same places.");
  save.reply_text = "the text";
  CommandSpec counts = Reading(
      command::kGetWorld, "get_world",
      "Returns how many things, robots, targets and lights there are, and how many edits can be undone and "
      "redone.",
      {Value("things"), Value("robots"), Value("targets"), Value("lights"), Value("undo"), Value("redo")});
  CommandSpec undo = edit(command::kUndo, "undo", "Takes back the last edit that was not taken back.");
  CommandSpec redo =
      edit(command::kRedo, "redo", "Makes the edit again that undo, or a reset, has taken back last.");
  CommandSpec pick{
      .id = command::kPick,
      .name = "pick",
      .help = "Returns what a ray from a point in a direction meets first.",
      .data = {Value("x", "m"), Value("y", "m"), Value("z", "m"), Value("dx"), Value("dy"), Value("dz")},
      .reply_params = {Value("id")},
      .reply_data = {Value("x", "m"), Value("y", "m"), Value("z", "m"), Value("distance", "m")},
      .reply_text = "its name; `floor`, with id 0; empty, with id -1 and an infinite distance: nothing",
      .example = "pick 0 0 5 0 0 -1"};
  return CommandTable("world", {std::move(insert), std::move(remove), std::move(pose), std::move(set),
                                std::move(rename), std::move(list), std::move(save), std::move(undo),
                                std::move(redo), std::move(pick), std::move(counts)});
}

CommandTable SwarmTable() {
  const auto team = [](std::int32_t id, std::string name, std::string help) {
    CommandSpec spec = Order(id, std::move(name), std::move(help));
    spec.reply_params = {Repeated("id")};
    spec.reply_text = "the names of the team, separated by spaces";
    return spec;
  };
  CommandSpec claim = team(command::kClaim, "claim",
                           "Takes robots or whole swarms into the team, with all their actuators: all of the "
                           "named ones or none. Without names: all that nobody drives.");
  CommandSpec release =
      team(command::kRelease, "release", "Gives up robots or whole swarms of this team. Without names: all.");
  for (CommandSpec* spec : {&claim, &release}) {
    spec->text = TextUse::kRest;
    spec->text_name = "NAME…";
    spec->text_optional = true;
  }
  claim.example = "claim robot1 robot2";
  release.example = "release robot2";
  const ValueSpec robot{.name = "robot", .unit = "", .repeated = true, .min = 1};
  const std::vector<ValueSpec> table_shape = {
      {.name = "mode", .unit = "", .enums = ModeWords()}, Value("rows"), Value("columns")};
  return CommandTable(
      "swarm",
      {
          std::move(claim),
          std::move(release),
          {.id = command::kStepAll,
           .name = "step_all",
           .help = "Tells the robots of the team what to do, a row of values each: velocities (linear m/s, "
                   "angular rad/s), wheels (left, right rad/s), or positions, positions_direct, "
                   "joint_velocities or efforts, one value a joint, of all joints or of a group "
                   "(positions/arm). Several words: their values one after the other in each row. No robots "
                   "named: all; free robots join the team. Without data they go on as they do. The reply "
                   "comes after the next step.",
           .text = TextUse::kFirst,
           .text_name = "COMMAND…",
           .params = {robot},
           .data = {{.name = "value", .unit = "", .repeated = true, .any_number = true}},
           .reply_params = table_shape,
           .reply_data = {Repeated("reading")},
           .reply_text = "`limited N robots` if some were scaled; who was taken from the team",
           .example = "step_all (1 2) 0.2 0.5 0.1 0"},
          {.id = command::kSelectReadings,
           .name = "select_readings",
           .help =
               "Chooses the columns of step_all and read_all: pose, distances, targets, neighbours (of "
               "the nearest, 8 by default), wheels, compass, support, joints, or a sensor's module by its "
               "name, e.g. lidar. Without words: pose distances.",
           .text = TextUse::kRest,
           .text_name = "READING…",
           .params = {{.name = "nearest", .unit = "", .optional = true, .min = 1}},
           .reply_params = {Repeated("columns")},
           .reply_text = "the names of the readings, separated by spaces",
           .example = "select_readings pose distances",
           .text_optional = true},
          {.id = command::kReadAll,
           .name = "read_all",
           .help = "Returns what step_all returns, at once, for the team or for any robots.",
           .params = {robot},
           .reply_params = table_shape,
           .reply_data = {Repeated("reading")},
           .example = "read_all 1 2"},
          team(command::kGetTeam, "get_team", "Returns the robots that this connection owns."),
          Order(command::kStopTeam, "stop_team", "Stops all robots of the team."),
      });
}

CommandTable RecorderTable() {
  CommandSpec recording =
      Reading(command::kGetRecording, "get_recording", "Returns what is being recorded.",
              {Value("begin", "s"), Value("end", "s"), Value("steps"), Value("lost"), Value("bytes")});
  recording.reply_params = {{.name = "recording", .unit = "", .enums = OffOn()}};
  recording.reply_text = "the name of the recording";
  CommandSpec stop =
      Order(command::kStopRecording, "stop", "Ends the recording. The reply comes when its file is closed.");
  stop.reply_text = "its name, and where the page has it";
  CommandSpec list = Order(command::kListRuns, "list", "Lists the recordings.");
  list.reply_text = "JSON";
  return CommandTable("recorder",
                      {
                          std::move(recording),
                          {.id = command::kStartRecording,
                           .name = "start",
                           .help = "Records the run from here on. Without a name: as run-DATE-TIME.",
                           .text = TextUse::kRest,
                           .text_name = "NAME",
                           .reply_text = "the name of the recording",
                           .example = "start lesson1",
                           .text_optional = true},
                          std::move(stop),
                          {.id = command::kNote,
                           .name = "note",
                           .help = "Marks this time in the recording.",
                           .text = TextUse::kRest,
                           .text_name = "NOTE",
                           .example = "note the robots meet"},
                          std::move(list),
                          {.id = command::kDeleteRun,
                           .name = "delete",
                           .help = "Deletes a recording for good.",
                           .text = TextUse::kRest,
                           .text_name = "NAME",
                           .example = "delete lesson1"},
                          {.id = command::kRenameRun,
                           .name = "rename",
                           .help = "Gives a recording another name.",
                           .text = TextUse::kRest,
                           .text_name = "NAME/NEW_NAME",
                           .reply_text = "the new name",
                           .example = "rename lesson1/reached the target"},
                      });
}

CommandTable PlaybackTable() {
  CommandSpec playback =
      Reading(command::kGetPlayback, "get_playback", "Returns which recording is played, and what is shown.",
              {Value("begin", "s"), Value("end", "s"), Value("time", "s"), Value("speed")});
  playback.reply_params = {{.name = "playing", .unit = "", .enums = OffOn()},
                           {.name = "loop", .unit = "", .enums = OffOn()},
                           {.name = "growing", .unit = "", .enums = OffOn()}};
  playback.reply_text = "the name of the recording";
  return CommandTable(
      "playback",
      {
          std::move(playback),
          {.id = command::kSeek,
           .name = "seek",
           .help = "Shows the step at this simulated time, or the one before it.",
           .data = {Value("time", "s")},
           .example = "seek 12.5"},
          {.id = command::kPlay,
           .name = "play",
           .help = "Lets the recording go on, at this speed if one is given.",
           .data = {Optional("speed")},
           .example = "play 2"},
          Order(command::kPausePlayback, "pause", "Stops the recording where it is."),
          {.id = command::kSetPlaySpeed,
           .name = "set_speed",
           .help = "Sets how fast the recording goes: -4 to 64, negative = backwards.",
           .data = {Value("factor")},
           .example = "set_speed -1"},
          {.id = command::kSkip,
           .name = "step",
           .help = "Shows the recorded step that is this many steps ahead (default 1; negative = back), and "
                   "stops there.",
           .params = {Optional("steps")},
           .example = "step -10"},
          {.id = command::kSetLoop,
           .name = "set_loop",
           .help = "Chooses whether the recording starts again at its end.",
           .params = {{.name = "loop", .unit = "", .enums = OffOn()}},
           .example = "set_loop on"},
          {.id = command::kBranch,
           .name = "branch",
           .help = "Ends the playback: the simulation goes on live from the step shown, or from this time.",
           .data = {Optional("time", "s")},
           .example = "branch"},
          {.id = command::kOpenRecording,
           .name = "open",
           .help = "Plays a recording of the daemon (/recorder list). The live run is put aside until close.",
           .text = TextUse::kRest,
           .text_name = "NAME",
           .example = "open lesson1"},
          Order(command::kCloseRecording, "close",
                "Ends the playback: the live run goes on where it was put aside."),
      });
}

}  // namespace coopdyn
