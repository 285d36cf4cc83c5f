// SPDX-License-Identifier: MIT
#include "server/yarp/board_words.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "server/yarp/board_call.h"

namespace coopdyn {
namespace {

using Form = BoardRequest::Form;

using Scope = BoardScope;

// Words after [get].
constexpr BoardWord kAsking[] = {
    {"axes", BoardItem::kAxes, Scope::kBoard},         {"mnum", BoardItem::kAxes, Scope::kBoard},
    {"mtnm", BoardItem::kAxes, Scope::kBoard},         {"name", BoardItem::kName, Scope::kOne},
    {"type", BoardItem::kType, Scope::kOne},           {"enc", BoardItem::kPosition, Scope::kOne},
    {"encs", BoardItem::kPosition, Scope::kAll},       {"esp", BoardItem::kVelocity, Scope::kOne},
    {"esps", BoardItem::kVelocity, Scope::kAll},       {"mnc", BoardItem::kPosition, Scope::kOne},
    {"mncs", BoardItem::kPosition, Scope::kAll},       {"msp", BoardItem::kVelocity, Scope::kOne},
    {"msps", BoardItem::kVelocity, Scope::kAll},       {"don", BoardItem::kDone, Scope::kOne},
    {"dons", BoardItem::kDone, Scope::kBoard},         {"dong", BoardItem::kDone, Scope::kCounted},
    {"vlim", BoardItem::kVelocityLimits, Scope::kOne}, {"llim", BoardItem::kPositionLimits, Scope::kOne},
    {"asts", BoardItem::kAmplifier, Scope::kOne},      {"asta", BoardItem::kAmplifier, Scope::kAll},
    {"gbxr", BoardItem::kGearRatio, Scope::kOne},      {"mcpr", BoardItem::kCounts, Scope::kOne},
};
// Words after [set].
constexpr BoardWord kTelling[] = {
    {"rel", BoardItem::kRelative, Scope::kOne},        {"rels", BoardItem::kRelative, Scope::kAll},
    {"relg", BoardItem::kRelative, Scope::kCounted},   {"sto", BoardItem::kStop, Scope::kOne},
    {"stos", BoardItem::kStop, Scope::kBoard},         {"stog", BoardItem::kStop, Scope::kCounted},
    {"llim", BoardItem::kPositionLimits, Scope::kOne}, {"vlim", BoardItem::kVelocityLimits, Scope::kOne},
};
// Words after [get] or [set].
constexpr BoardWord kBoth[] = {
    {"pos", BoardItem::kTarget, Scope::kOne},
    {"poss", BoardItem::kTarget, Scope::kAll},
    {"posg", BoardItem::kTarget, Scope::kCounted},
    {"dpo", BoardItem::kDirect, Scope::kOne},
    {"dpos", BoardItem::kDirect, Scope::kAll},
    {"dpog", BoardItem::kDirect, Scope::kCounted},
    {"vmo", BoardItem::kVelocityReference, Scope::kOne},
    {"vmos", BoardItem::kVelocityReference, Scope::kAll},
    {"vmog", BoardItem::kVelocityReference, Scope::kCounted},
    {"vel", BoardItem::kSpeed, Scope::kOne},
    {"vels", BoardItem::kSpeed, Scope::kAll},
    {"velg", BoardItem::kSpeed, Scope::kCounted},
    {"acc", BoardItem::kAcceleration, Scope::kOne},
    {"accs", BoardItem::kAcceleration, Scope::kAll},
    {"accg", BoardItem::kAcceleration, Scope::kCounted},
};
// Words after [torq].
constexpr BoardWord kTorques[] = {
    {"trq", BoardItem::kEffort, Scope::kOne},      {"trqs", BoardItem::kEffort, Scope::kAll},
    {"rng", BoardItem::kTorqueRange, Scope::kOne}, {"rngs", BoardItem::kTorqueRange, Scope::kAll},
    {"ref", BoardItem::kTorque, Scope::kOne},      {"refs", BoardItem::kTorque, Scope::kAll},
    {"refg", BoardItem::kTorque, Scope::kCounted},
};
// Words after [pid].
constexpr BoardWord kPids[] = {
    {"pid", BoardItem::kPid, Scope::kOne},          {"pids", BoardItem::kPid, Scope::kAll},
    {"ref", BoardItem::kPidReference, Scope::kOne}, {"refs", BoardItem::kPidReference, Scope::kAll},
    {"err", BoardItem::kPidError, Scope::kOne},     {"errs", BoardItem::kPidError, Scope::kAll},
    {"out", BoardItem::kPidOutput, Scope::kOne},    {"outs", BoardItem::kPidOutput, Scope::kAll},
    {"ena", BoardItem::kPidEnabled, Scope::kOne},   {"res", BoardItem::kPidReset, Scope::kOne},
};
// First words of streamed commands.
constexpr BoardWord kStreams[] = {
    {"vmo", BoardItem::kVelocityReference, Scope::kOne},
    {"vmos", BoardItem::kVelocityReference, Scope::kAll},
    {"vmog", BoardItem::kVelocityReference, Scope::kCounted},
    {"dpo", BoardItem::kDirect, Scope::kOne},
    {"dpos", BoardItem::kDirect, Scope::kAll},
    {"dpog", BoardItem::kDirect, Scope::kCounted},
    {"dtq", BoardItem::kTorque, Scope::kOne},
    {"dtqs", BoardItem::kTorque, Scope::kAll},
    {"dtqg", BoardItem::kTorque, Scope::kCounted},
    {"poss", BoardItem::kTarget, Scope::kAll},
    {"vdso", BoardItem::kVelocityReference, Scope::kOne},
    {"vdsa", BoardItem::kVelocityReference, Scope::kAll},
    {"vdsg", BoardItem::kVelocityReference, Scope::kCounted},
};
constexpr BoardWord kModes[] = {{"cmod", BoardItem::kMode, Scope::kOne},
                                {"cmds", BoardItem::kMode, Scope::kAll},
                                {"cmog", BoardItem::kMode, Scope::kCounted}};
constexpr BoardWord kInteractions[] = {{"mode", BoardItem::kCompliant, Scope::kOne},
                                       {"mods", BoardItem::kCompliant, Scope::kAll},
                                       {"modg", BoardItem::kCompliant, Scope::kCounted}};
constexpr BoardWord kImpedances[] = {{"ipr", BoardItem::kImpedance, Scope::kOne},
                                     {"iof", BoardItem::kImpedanceOffset, Scope::kOne},
                                     {"llim", BoardItem::kImpedanceLimits, Scope::kOne}};

// Words that set or reset encoders; words that ask for accelerations.
constexpr std::string_view kEncoderWords[] = {"enc",  "encs", "ere",  "eres", "mnc",
                                              "mncs", "mre",  "mres", "mcpr"};
constexpr std::string_view kAccelerations[] = {"eac", "eacs", "mac", "macs"};

constexpr const char* kNotNeeded = "a simulated joint needs no calibration, and has no place to park";

BoardRequest Fixed(Bottle answer) {
  return {.form = Form::kFixed, .fixed = std::move(answer)};
}

BoardRequest Refuse(const std::string& why) {
  return Fixed(BoardFailure(why));
}

/// `at`: the index of the word's first argument. `shown`: the word in the answer.
BoardRequest RequestOf(const BoardWord& word, bool tells, const Bottle& request, std::size_t at,
                       const BottleValue& shown, Form form, Form form_of_all) {
  BoardRequest made{.form = Form::kSet, .call = MakeBoardCall(word, tells, request, at), .word = shown};
  const bool all =
      word.item != BoardItem::kDone && (word.scope == Scope::kAll || word.scope == Scope::kCounted);
  if (!tells) made.form = all ? form_of_all : form;
  return made;
}

BoardRequest OfPid(const Bottle& request, bool tells) {
  const BoardWord* const word = FindBoardWord(kPids, WordAt(request, 2));
  const std::string_view type = WordAt(request, 3);
  const bool told = word != nullptr && (word->item == BoardItem::kPid || word->item == BoardItem::kPidReset);
  if (word == nullptr || (tells && !told) || (!tells && word->item == BoardItem::kPidReset))
    return Refuse(
        "of a PID there are pid and pids; to be read also ref, err, out and ena; to be told also res");
  if (type != "pos" && type != "pos1") return Refuse(kNoBoardPid);
  return RequestOf(*word, tells, request, 4, request[1], Form::kPlain, Form::kPlainAll);
}

BoardRequest OfInterface(const Bottle& request, bool tells) {
  const std::string_view which = request[1].word(), name = WordAt(request, 2);
  if (which == "pid") return OfPid(request, tells);
  if (which == "ipwm" || which.starts_with("pwm")) return Refuse(kNoBoardPwm);
  if (which == "icur") return Refuse(kNoBoardCurrent);
  const auto of = [&](const BoardWord* word, std::size_t shown, Form form, Form form_of_all,
                      const char* words) {
    if (word == nullptr) return Refuse(words);
    return RequestOf(*word, tells, request, 3, request[shown], form, form_of_all);
  };
  if (which == "icmd") {
    const std::size_t shown = name == "cmod" && request.size() > 3 ? 3 : 2;
    return of(FindBoardWord(kModes, name), shown, Form::kGet, Form::kGetAll,
              "of modes there are cmod, cmds and cmog");
  }
  if (which == "intm")
    return of(FindBoardWord(kInteractions, name), 2, Form::kBare, Form::kBareAll,
              "of interaction modes there are mode, mods and modg");
  if (which == "torq")
    return of(FindBoardWord(kTorques, name), 1, Form::kGet, Form::kGetAll,
              "of torques there are ref, refs and refg; to be read also trq and rng");
  if (which == "iimp")
    return of(FindBoardWord(kImpedances, name), 1, Form::kGet, Form::kGet,
              "of impedances there are ipr and iof; to be read also llim");
  if (which == "ivar") {
    if (name == "lvar" && !tells)
      return Fixed(BottleOf(YarpVocab{"is"}, YarpVocab{"ivar"}, Bottle(), YarpVocab{"ok"}));
    return Refuse("this board has no remote variables");
  }
  if (which == "reca") {
    if (name == "isca" && !tells)
      return Fixed(BottleOf(YarpVocab{"is"}, YarpVocab{"reca"}, std::int32_t{0}, YarpVocab{"ok"}));
    return Refuse(kNotNeeded);
  }
  if (which == "ijfl" && !tells)
    return Fixed(BottleOf(YarpVocab{"is"}, std::int32_t{0}, std::string(), YarpVocab{"ok"}));
  if (tells && std::ranges::find(kEncoderWords, which) != std::end(kEncoderWords))
    return Refuse("encoders are those of the robot's model: they cannot be set");
  if (!tells && std::ranges::find(kAccelerations, which) != std::end(kAccelerations))
    return Refuse("stateExt:o has the accelerations: they are differences between two samples");
  return Refuse("there is no " + std::string(which) + ": help lists the words");
}

Bottle Help() {
  Bottle help = BottleOf(YarpVocab{"many"});
  for (const char* const line :
       {"A control board of YARP: degrees, degrees/s and N m; metres where joints slide. Joints from 0.",
        "get axes | name J | type J | llim J | vlim J",
        "get encs | enc J | esps | esp J            positions, velocities",
        "set pos J DEGREES | poss (…) | posg N (J …) (…) | rel J DEGREES | rels (…)",
        "get pos J | poss (targets), don J | dons (has it arrived), set sto J | stos (stop)",
        "set vel J SPEED | vels (…), acc J … | accs (…)   of ways to positions; also get",
        "set vmo J SPEED | vmos (…)                 velocities; get tells the references",
        "set dpo J DEGREES | dpos (…)               where joints are to be at the end of the step",
        "set torq ref J NM | refs (…), get torq trq J | trqs | rng J",
        "get icmd cmod J | cmds, set icmd cmod J pos   modes: idl pos posd vel torq",
        "get intm mode J | mods, set intm mode J comp  or stif",
        "set iimp ipr J (STIFFNESS DAMPING), set iimp iof J (TORQUE); also get",
        "get pid pid pos J, set pid pid pos J (KP KD KI 0 0 0 0 0 0 0)"}) {
    help.emplace_back(std::string(line));
  }
  return help;
}

Bottle Doubles(const std::vector<double>& values) {
  Bottle list;
  for (const double value : values) list.emplace_back(value);
  return list;
}

/// True for counts, truth values and codes.
bool IsWhole(BoardItem item) {
  return item == BoardItem::kAxes || item == BoardItem::kDone || item == BoardItem::kType ||
         item == BoardItem::kPidEnabled || item == BoardItem::kAmplifier;
}

BottleValue ValueOf(BoardItem item, double value) {
  if (item == BoardItem::kMode)
    return {YarpVocab{std::string(BoardModeWord(static_cast<BoardMode>(static_cast<int>(value))))}};
  if (item == BoardItem::kCompliant) return {YarpVocab{value == 1 ? "comp" : "stif"}};
  constexpr std::int32_t kTurns = 1987212385, kSlides = 1919972449;  // the vocabs atrv and atpr
  if (item == BoardItem::kType) return {value == 1 ? kSlides : kTurns};
  if (IsWhole(item)) return {static_cast<std::int32_t>(value)};
  return {value};
}

/// Appends the values of all joints: one list per value of a joint; for PIDs one list per joint.
void AppendLists(BoardItem item, const std::vector<double>& values, Bottle& answer) {
  const std::size_t width = std::max<std::size_t>(BoardWidth(item), 1), count = values.size() / width;
  if (item == BoardItem::kPid) {
    Bottle pids;
    for (std::size_t i = 0; i < count; ++i)
      pids.emplace_back(Doubles({values.begin() + static_cast<std::ptrdiff_t>(i * width),
                                 values.begin() + static_cast<std::ptrdiff_t>((i + 1) * width)}));
    answer.emplace_back(std::move(pids));
    return;
  }
  for (std::size_t k = 0; k < width; ++k) {
    Bottle list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(ValueOf(item, values[i * width + k]));
    answer.emplace_back(std::move(list));
  }
}

}  // namespace

Bottle BoardFailure(const std::string& why) {
  return BottleOf(YarpVocab{"fail"}, why);
}

BoardRequest ReadBoardWords(const Bottle& request) {
  const std::string_view verb = request.empty() ? std::string_view() : request[0].word();
  if (verb == "help") return Fixed(Help());
  if (request.size() < 2) return {};
  const bool tells = verb == "set";
  if (!tells && verb != "get") return Refuse("begin with get or set: help lists the words");
  const std::string_view word = request[1].word();
  if (word == "prot" && !tells)
    return Fixed(
        BottleOf(YarpVocab{"prot"}, std::int32_t{1}, std::int32_t{9}, std::int32_t{0}, YarpVocab{"ok"}));
  if (tells && (word == "aen" || word == "adi")) {
    BoardRequest amplifier{.form = Form::kSet};
    amplifier.call = MakeBoardCall({word, BoardItem::kAmplifier, Scope::kOne}, false, request, 2);
    amplifier.call.tells = true;
    amplifier.call.values = {word == "aen" ? 1.0 : 0.0};
    return amplifier;
  }
  const BoardWord* found = FindBoardWord(kBoth, word);
  if (found == nullptr) found = tells ? FindBoardWord(kTelling, word) : FindBoardWord(kAsking, word);
  if (found != nullptr) return RequestOf(*found, tells, request, 2, request[1], Form::kGet, Form::kGetAll);
  return OfInterface(request, tells);
}

Bottle BoardWords(const BoardRequest& request, const BoardAnswer& answer, double time_s, std::int32_t count) {
  if (request.form == Form::kFixed) return request.fixed;
  if (request.form == Form::kUnknown) return BottleOf(YarpVocab{"nak"});
  if (answer.kind != BoardAnswer::Kind::kDone) return BoardFailure(answer.why);
  if (request.form == Form::kSet) return BottleOf(YarpVocab{"ok"});
  const BoardItem item = request.call.item;
  Bottle words;
  if (request.form != Form::kBare && request.form != Form::kBareAll) {
    words.emplace_back(YarpVocab{"is"});
    words.push_back(request.word);
  }
  if (request.form == Form::kGetAll || request.form == Form::kPlainAll || request.form == Form::kBareAll) {
    AppendLists(item, answer.values, words);
  } else if (item == BoardItem::kPid || item == BoardItem::kImpedance ||
             item == BoardItem::kImpedanceOffset || item == BoardItem::kImpedanceLimits) {
    words.emplace_back(Doubles(answer.values));
  } else {
    for (const double value : answer.values) words.push_back(ValueOf(item, value));
    for (const std::string& name : answer.names) words.emplace_back(name);
  }
  if (request.form != Form::kPlain && request.form != Form::kPlainAll) {
    words.emplace_back(YarpVocab{"tsta"});
    words.emplace_back(count);
    words.emplace_back(time_s);
  }
  words.emplace_back(YarpVocab{"ok"});
  return words;
}

BoardCall ReadBoardStream(const Bottle& message) {
  const Bottle* const head = message.size() == 2 ? message[0].As<Bottle>() : nullptr;
  const Bottle* const body = message.size() == 2 ? message[1].As<Bottle>() : nullptr;
  if (head == nullptr || body == nullptr || head->empty())
    return RefuseBoardCall("a command is two lists: ([vmos]) (10.0 20.0)");
  std::size_t at = 0;
  // YARP 4 puts the interface before the word.
  for (const std::string_view interface : {"ipos", "ipod", "ivel", "ived", "itrq"}) {
    if ((*head)[0].word() == interface && head->size() > 1) at = 1;
  }
  const std::string_view name = (*head)[at].word();
  if (name == "icur") return RefuseBoardCall(kNoBoardCurrent);
  if (name == "ipwm") return RefuseBoardCall(kNoBoardPwm);
  const BoardWord* const word = FindBoardWord(kStreams, name);
  if (word == nullptr) return RefuseBoardCall("there is no command " + std::string(name));
  return MakeBoardCall(*word, *head, at + 1, *body);
}

}  // namespace coopdyn
