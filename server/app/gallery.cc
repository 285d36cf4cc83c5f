// SPDX-License-Identifier: MIT
#include "server/app/gallery.h"

#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <chrono>
#include <optional>
#include <system_error>

#include "protocol/ascii.h"
#include "protocol/json_text.h"
#include "server/app/checker.h"
#include "server/app/model_text.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr std::array<const char*, 3> kWords = {"world", "scenario", "robot"};
constexpr std::size_t kMaxTitle = 160;

std::string FirstSentence(const std::string& text) {
  std::size_t end = text.find(". ");
  while (end != std::string::npos && !(end + 2 < text.size() && IsUpper(text[end + 2])))
    end = text.find(". ", end + 1);  // an abbreviation
  std::string sentence = text.substr(0, end == std::string::npos ? text.size() : end + 1);
  if (sentence.size() > kMaxTitle) {
    sentence.resize(sentence.rfind(' ', kMaxTitle) == std::string::npos ? kMaxTitle
                                                                        : sentence.rfind(' ', kMaxTitle));
    sentence += " …";
  }
  return sentence;
}

/// Joins several lines to one.
std::string Joined(std::string_view text) {
  std::string joined;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\n' || c == '\r' || c == '\t';
    if (!blank) {
      joined += c;
    } else if (!joined.empty() && joined.back() != ' ') {
      joined += ' ';
    }
  }
  return std::string(Trim(joined));
}

/// The first <!-- comment --> that is not about the licence.
std::string XmlTitle(std::string_view text) {
  constexpr std::size_t kHead = 4096;
  text = text.substr(0, kHead);
  for (std::size_t begin = 0; (begin = text.find("<!--", begin)) != std::string_view::npos; ++begin) {
    const std::size_t end = text.find("-->", begin);
    const std::string_view comment =
        text.substr(begin + 4, end == std::string_view::npos ? end : end - begin - 4);
    if (comment.find("SPDX") == std::string_view::npos && comment.find("icense") == std::string_view::npos)
      return FirstSentence(Joined(comment));
  }
  return {};
}

std::uint64_t StampOf(fs::file_time_type written) {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(
                                        std::chrono::file_clock::to_sys(written).time_since_epoch())
                                        .count());
}

/// Views a robot that stands alone at the origin from its front left.
void LookAtRobot(const Frame& frame, ImageRequest& request) {
  const RobotModel& model = *frame.scene->robots.front().entry.model;
  const double height_m = std::max(model.height_m, 0.02);
  const double size_m = std::max(model.footprint_radius_m, 0.6 * height_m);
  request.look_m = Vector3(0, 0, 0.45 * height_m);
  request.eye_m = *request.look_m + 3.2 * size_m * Vector3(0.75, 0.55, 0.45);
}

}  // namespace

std::string Gallery::TitleOf(const std::string& text) {
  std::string_view rest = text;
  std::string title;
  if (IsXml(text)) return XmlTitle(text);
  while (!rest.empty()) {
    const std::string_view line = Trim(TakeLine(rest));
    if (!line.starts_with('#')) {
      if (line.empty() && title.empty()) continue;
      break;
    }
    title += std::string(line.substr(1)) + " ";
  }
  return FirstSentence(Joined(title));
}

std::vector<std::string> NamesOf(const SearchPath& path, const std::string& what) {
  if (what == "worlds") return path.WorldNames();
  return what == "robots" ? path.RobotNames() : path.ScenarioNames();
}

std::vector<std::string> Gallery::NamesOf(GalleryKind kind) const {
  std::vector<std::string> names =
      coopdyn::NamesOf(path_, kWords[static_cast<std::size_t>(kind)] + std::string("s"));
  if (names.size() > kMaxListed) names.resize(kMaxListed);
  return names;
}

fs::path Gallery::FileOf(GalleryKind kind, const std::string& name) const {
  if (kind == GalleryKind::kRobot) return path_.FindRobot(name).value_or("");
  if (kind == GalleryKind::kWorld) return path_.FindWorld(name + ".world", {}).value_or("");
  const auto scenario = path_.FindScenario(name + ".scenario");
  return scenario ? *scenario : path_.FindScenario(name + ".xml").value_or("");
}

const Gallery::Known& Gallery::Look(GalleryKind kind, const std::string& name, const fs::path& file,
                                    RobotLibrary& robots) {
  std::error_code failed;
  const fs::file_time_type written = fs::last_write_time(file, failed);
  const auto found = known_.find(file);
  if (found != known_.end() && found->second.written == written) return found->second;
  Known known{written, {}, {}};
  Diagnostics diagnostics;
  const std::optional<std::string> text = ReadTextFile(file.string(), {file.string(), 0}, diagnostics);
  if (text) known.title = TitleOf(*text);
  if (kind == GalleryKind::kRobot) {
    const auto model = robots.Get(name, {file.string(), 0}, diagnostics);
    if (model != nullptr) known.summary = SummaryOf(*model);
  } else {
    const auto scenario = LoadScenario(file.string(), robots, diagnostics);
    if (scenario != nullptr) known.summary = Summary(*scenario);
  }
  if (diagnostics.has_errors()) known.summary = ToString(diagnostics.all().front());
  return known_.insert_or_assign(file, std::move(known)).first->second;
}

std::optional<std::string> Gallery::TextOf(const std::string& kind, const std::string& name) const {
  const GalleryKind of = kind == "world" ? GalleryKind::kWorld : GalleryKind::kScenario;
  const std::vector<std::string> names = NamesOf(of);
  if (std::find(names.begin(), names.end(), name) == names.end()) return std::nullopt;
  Diagnostics ignored;
  const std::string file = FileOf(of, name).string();
  return ReadTextFile(file, {file, 0}, ignored);
}

std::string Gallery::List(const std::stop_token& stop) {
  json::object all;
  RobotLibrary robots(path_);  // reads each model once
  for (const GalleryKind kind : {GalleryKind::kWorld, GalleryKind::kScenario, GalleryKind::kRobot}) {
    const std::string word = kWords[static_cast<std::size_t>(kind)];
    json::array list;
    for (const std::string& name : NamesOf(kind)) {
      const fs::path file = FileOf(kind, name);
      if (stop.stop_requested()) return JsonText(all);
      if (file.empty()) continue;
      const Known& known = Look(kind, name, file, robots);
      const std::string thumb =
          "/thumb/" + word + "/" + name + ".png?t=" + std::to_string(StampOf(known.written));
      list.push_back({{"name", name},
                      {"title", known.title},
                      {"summary", known.summary},
                      {"thumb", draw_ ? json::value(json::string(thumb)) : json::value(nullptr)}});
    }
    all[word + "s"] = std::move(list);
  }
  return JsonText(all);
}

ImageResult Gallery::Thumb(const std::string& kind_word, const std::string& name) {
  ImageResult none;
  none.is_unknown = true;
  none.error = "there is no such " + kind_word;
  const auto* const found = std::ranges::find(kWords, kind_word);
  if (found == kWords.end()) return none;
  const auto kind = static_cast<GalleryKind>(found - kWords.begin());
  // Accept only listed names, so that a name cannot reach other files.
  const std::vector<std::string> names = NamesOf(kind);
  const fs::path file = std::ranges::find(names, name) == names.end() ? fs::path() : FileOf(kind, name);
  if (file.empty()) return none;
  std::error_code failed;
  const fs::file_time_type written = fs::last_write_time(file, failed);
  const auto kept = pictures_.find(file);
  if (kept != pictures_.end() && kept->second.written == written) return kept->second.result;
  ImageResult result = Draw(kind, file);
  if (!result.error.empty()) return result;
  if (pictures_.size() >= kMaxKept) pictures_.clear();
  return pictures_.insert_or_assign(file, Picture{written, std::move(result)}).first->second.result;
}

ImageResult Gallery::Draw(GalleryKind kind, const fs::path& file) const {
  ImageResult none;
  Diagnostics diagnostics;
  RobotLibrary robots(path_);
  ImageRequest request;
  request.frame = CheckFile(file.string(), robots, diagnostics).frame;
  if (request.frame == nullptr) {
    none.error = diagnostics.all().empty() ? "there is nothing to see" : ToString(diagnostics.all().front());
    return none;
  }
  request.width = kWidth;
  request.height = kHeight;
  request.show_names = false;
  if (kind == GalleryKind::kRobot) LookAtRobot(*request.frame, request);
  return draw_(std::move(request));
}

}  // namespace coopdyn
