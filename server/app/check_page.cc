// SPDX-License-Identifier: MIT
// A check's report as a page of text.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "server/app/check_report.h"
#include "server/app/model_text.h"
#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// `text` without the list of searched folders.
std::string Shortened(std::string text) {
  const std::size_t begin = text.find(" (looked for in "), end = text.find(')', begin);
  if (begin != std::string::npos && end != std::string::npos) text.erase(begin, end + 1 - begin);
  return text;
}

/// The end of the last clause of `text` before `most`, outside of quotes; 0 if there is none.
std::size_t EndOfClause(const std::string& text, std::size_t most) {
  bool quoted = false;
  std::size_t found = 0;
  for (std::size_t i = 0; i < most; ++i) {
    if (text[i] == '\'') quoted = !quoted;
    if (!quoted && text[i + 1] == ' ' && std::string_view(",;:").find(text[i]) != std::string_view::npos)
      found = i;
  }
  return found;
}

/// `text` printable and cut to about `most` bytes: at the end of a clause, so that no command is cut, unless
/// clauses are too long.
std::string Cut(const std::string& text, std::size_t most) {
  std::string cut = Printable(text);
  if (cut.size() <= most) return cut;
  if (const std::size_t clause = EndOfClause(cut, most); clause > most / 3) most = clause;
  while (most > 0 && (static_cast<unsigned char>(cut[most]) & 0xc0) == 0x80) --most;
  cut.resize(most);
  return cut + " …";
}

class PageText {
 public:
  explicit PageText(bool verbose) : verbose_(verbose) {}

  void Line(std::string_view indent, const std::string& text) {
    constexpr std::size_t kWidest = 290;
    text_ += std::string(indent) + (verbose_ ? Printable(text) : Cut(text, kWidest)) + '\n';
  }

  /// Adds a title and at most `most` of the lines `line(i)`.
  template <typename Make>
  void List(std::size_t count, std::size_t most, const std::string& title, Make line) {
    if (count == 0) return;
    Line("", title);
    const std::size_t shown = verbose_ || count <= most + 1 ? count : most;
    for (std::size_t i = 0; i < shown; ++i) Line("  ", line(i));
    if (shown < count) Line("  ", "and " + std::to_string(count - shown) + " more: --verbose shows them");
  }

  void Program(const std::string& title, const std::string& lines) {
    Line("", title);
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t end = lines.find('\n', at);
      text_ += "  " + Printable(lines.substr(at, end - at)) + '\n';
      at = end + 1;
    }
  }

  std::string text() const { return text_; }

 private:
  const bool verbose_;
  std::string text_;
};

std::string FindingText(const Finding& one, const std::string& file, bool verbose) {
  const std::filesystem::path from = one.where.file;
  const std::string short_name = (from.parent_path().filename() / from.filename()).string();
  std::string text = one.where.file == file ? "" : Cut(short_name, 60) + " ";
  if (one.where.line > 0) text += "line " + std::to_string(one.where.line);
  if (!text.empty()) text += ": ";
  constexpr std::size_t kLongest = 150, kLongestAlone = 260;
  text += verbose ? one.what : Cut(Shortened(one.what), one.why.empty() ? kLongestAlone : kLongest);
  if (one.count > 1) text += " (" + std::to_string(one.count) + " times)";
  return one.why.empty() ? text : text + ": " + one.why;
}

std::string MotorText(const RobotModel& model) {
  const std::vector<std::size_t> joints = MovingJoints(model);
  if (joints.empty()) return "no joints";
  const auto motors = std::ranges::count_if(joints, [&](std::size_t j) { return HasMotor(model, j); });
  return std::to_string(motors) + " of " + CountOf(joints.size(), "joint") +
         (motors == 1 ? " has a motor" : " have motors");
}

/// A line per robot of a world; one line for all robots without sockets.
std::vector<std::string> RobotTexts(const std::vector<CheckedRobot>& robots) {
  std::vector<std::string> texts, others;
  for (const CheckedRobot& robot : robots) {
    if (!robot.drive) {
      others.push_back(robot.name);
      continue;
    }
    std::vector<std::string> modules;
    for (const ModuleModel& module : robot.model->modules()) modules.push_back(module.name);
    texts.push_back(robot.name + ": " + MotorText(*robot.model) + "; modules " + JoinNames(modules));
  }
  if (!others.empty()) texts.push_back("nothing to drive, and no sensors: " + JoinNames(others));
  return texts;
}

void AddModel(const RobotModel& model, PageText& page) {
  const std::vector<std::size_t> joints = MovingJoints(model);
  const auto thrusts =
      static_cast<std::size_t>(std::ranges::count_if(model.joints, [](const JointModel& one) {
        return one.kind == JointModel::Kind::kForce || one.kind == JointModel::Kind::kTorque;
      }));
  const std::string thrusters = thrusts == 0 ? "" : "; " + CountOf(thrusts, "thruster");
  const Vector3 size = SizeOf(model);
  const auto rounded = [](double value) { return FormatNumber(std::round(value * 1e3) / 1e3); };
  const std::string sizes = rounded(size.x()) + " x " + rounded(size.y()) + " x " + rounded(size.z()) + " m";
  page.Line("  ", (size.isZero() ? "no part of it collides or is drawn" : "size " + sizes) + "; " +
                      (model.drive() != nullptr ? std::string("a drive; ") : "") + MotorText(model) +
                      thrusters);
  const std::vector<ModuleModel> modules = model.modules();
  page.List(joints.size(), 6, "Joints:", [&](std::size_t i) { return JointText(model, joints[i]); });
  const std::vector<std::string> parts = PartTexts(model);
  page.List(parts.size(), 3, "Concave meshes:", [&](std::size_t i) { return parts[i]; });
  page.List(modules.size(), 6, "Modules:", [&](std::size_t i) { return ModuleText(model, modules[i]); });
}

}  // namespace

std::string PageOf(const CheckReport& report, bool verbose) {
  PageText page(verbose);
  page.Line("", report.file + ": " + ToString(report.verdict));
  page.Line("  ", report.format + (report.name.empty() ? "" : " '" + report.name + "'") +
                      (report.lines.empty() ? "" : ": " + report.lines.front()));
  if (report.model != nullptr) AddModel(*report.model, page);
  const std::vector<std::string> robots = RobotTexts(report.robots);
  page.List(robots.size(), 6, "Robots:", [&](std::size_t i) { return robots[i]; });
  for (const CheckedRobot& robot : report.robots) {
    if (!verbose || report.model != nullptr || !robot.drive) continue;
    page.Line("", "Robot " + robot.name + ":");
    AddModel(*robot.model, page);
    page.Program("Python:", robot.drive->python);
  }
  const auto add = [&](const std::vector<Finding>& all, std::size_t most, const std::string& title) {
    page.List(all.size(), most, title,
              [&](std::size_t i) { return FindingText(all[i], report.file, verbose); });
  };
  add(report.errors, 8, "Wrong:");
  add(report.left_out, 5, "Left out or changed, and it matters:");
  add(report.mended, 4, "Mended:");
  add(report.harmless, verbose ? 1 : 2, "Left out, without harm:");
  const std::string search = "Not found (coopdyn check --search FOLDER FILE looks through a folder for it):";
  page.List(report.missing.size(), 3, search, [&](std::size_t i) {
    const MissingPart& part = report.missing[i];
    return part.what + (part.count > 1 ? ", " + CountOf(static_cast<std::size_t>(part.count), "file") : "") +
           (part.collides ? "" : " (only drawn)") + ": " + part.bring;
  });
  if (report.drive) {
    page.Program("Serve it:", report.drive->serve);
    page.Program("Python, with clients/python on PYTHONPATH:", report.drive->python);
    page.Program("MATLAB, with clients/matlab on its path:", report.drive->matlab);
    page.Program("YARP:", report.drive->yarp);
  }
  return page.text();
}

}  // namespace coopdyn
