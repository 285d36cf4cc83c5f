// SPDX-License-Identifier: MIT
#include "server/app/page_services.h"

#include <spdlog/fmt/fmt.h>
#include <sys/resource.h>

#include <boost/json.hpp>
#include <cmath>
#include <exception>
#include <utility>

#include "protocol/json_text.h"
#include "server/app/checker.h"
#include "server/app/run_views.h"
#include "server/control/branch_desk.h"
#include "server/model/text_file.h"
#include "server/model/values.h"
#include "server/state/edit_queue.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

constexpr int kNice = 10;  // the run has priority

/// Calls `done` with the result of `work`; turns exceptions into error answers.
template <typename Work>
void Answer(const WebFiles::Done& done, const Work& work) {
  try {
    done(work());
  } catch (const std::exception& error) {  // e.g. no more memory
    done(ErrorAnswer(500, std::string("internal error: ") + error.what()));
  }
}

/// {"ok":…,"summary":…,"errors":…,"warnings":…,"diagnostics":[{"file","line","severity","text"}]}; `name`
/// replaces `file` in it.
json::object Report(const Checked& checked, const Diagnostics& diagnostics, const std::string& file,
                    const std::string& name) {
  json::array list;
  for (const Diagnostic& one : diagnostics.all()) {
    list.push_back({{"file", one.where.file == file ? name : one.where.file},
                    {"line", one.where.line},
                    {"severity", one.level == Diagnostic::Level::kError ? "error" : "warning"},
                    {"text", one.text}});
  }
  return {{"ok", !diagnostics.has_errors()},
          {"summary",
           checked.lines.empty() ? json::value(nullptr) : json::value(json::string(checked.lines.front()))},
          {"errors", diagnostics.errors()},
          {"warnings", diagnostics.warnings()},
          {"diagnostics", std::move(list)}};
}

DrawImage DrawerOn(ImageBoard* images) {
  if (images == nullptr) return nullptr;
  return [images](ImageRequest request) { return images->Draw(std::move(request)); };
}

/// The text for load_scenario after an upload: a world's name, or a scenario with the robot on an empty
/// floor.
std::string LoadOf(const Upload& upload) {
  if (upload.kind == "world") return upload.name;
  return "[ROBOT_1]\ntype      " + upload.name + "\nposition  0 0\n";
}

}  // namespace

PageServices::PageServices(const SearchPath& path, const std::filesystem::path& uploads, ImageBoard* images,
                           RunFolder& runs, const RunControl& run, const ReplayServices& replay,
                           Logger logger)
    : path_(path),
      uploads_(uploads, path),
      gallery_(path, DrawerOn(images)),
      runs_(runs),
      run_(run),
      replay_{replay.clock, replay.logger, pool_, replay.controllers, replay.path},
      checks_("check", logger),
      drawings_("gallery", logger),
      views_("run views", logger) {
  for (IoThread* thread : {&checks_, &drawings_, &views_})
    thread->Post([] { ::setpriority(PRIO_PROCESS, 0, kNice); });  // on Linux, affects only this thread
}

PageServices::~PageServices() {
  stopping_.request_stop();
  checks_.Stop();
  drawings_.Stop();
  views_.Stop();
}

WebFiles PageServices::files() {
  const auto post = [this](auto work) {
    return [this, work](WebFile file, WebFiles::Done done) {
      if (++waiting_ > kMaxWaiting) {
        --waiting_;
        return done(ErrorAnswer(503, "too many texts wait to be checked: try again in a moment"));
      }
      checks_.Post([this, work, file = std::move(file), done = std::move(done)] {
        --waiting_;
        work(file, done);
      });
    };
  };
  WebFiles files;
  files.check = post([this](const WebFile& file, const WebFiles::Done& done) { Check(file, done); });
  files.upload = post([this](const WebFile& file, const WebFiles::Done& done) { Keep(file, done); });
  files.gallery = [this](WebFiles::Done done) {
    drawings_.Post([this, done = std::move(done)] {
      Answer(done, [this] { return JsonAnswer(gallery_.List(stopping_.get_token())); });
    });
  };
  files.thumb = [this](const std::string& kind, const std::string& name, WebFiles::Done done) {
    if (++pictures_ > kMaxPictures) {
      --pictures_;
      return done(ErrorAnswer(503, "too many pictures wait to be drawn: try again in a moment"));
    }
    drawings_.Post([this, kind, name, done = std::move(done)] {
      --pictures_;
      Answer(done, [&] {
        const ImageResult result = gallery_.Thumb(kind, name);
        if (!result.error.empty()) return ErrorAnswer(result.is_unknown ? 404 : 503, result.error);
        return HttpAnswer{.body = std::string(result.bytes->begin(), result.bytes->end()),
                          .type = "image/png",
                          .headers = {{"Cache-Control", "private, max-age=3600"}}};
      });
    });
  };
  // Texts do not queue behind pictures: a user waits for them.
  files.text = [this](const std::string& kind, const std::string& name, WebFiles::Done done) {
    checks_.Post([this, kind, name, done = std::move(done)] {
      Answer(done, [&] {
        const std::optional<std::string> text = gallery_.TextOf(kind, name);
        if (!text) return ErrorAnswer(404, "there is no " + kind + " of that name: /api/gallery lists them");
        return HttpAnswer{.body = *text, .headers = {{"Cache-Control", "no-store"}}};
      });
    });
  };
  files.run = [this](const RunView& view, WebFiles::Done done) {
    if (++viewing_ > kMaxViews) {
      --viewing_;
      return done(ErrorAnswer(503, "too many recordings are looked into: try again in a moment"));
    }
    const auto refuse = [this, done](const RunToCopy& run) {
      --viewing_;
      done(ErrorAnswer(run.error == Error::kNoSuchName ? 404 : 409, run.text));
    };
    const auto look = [this, view, done](const std::string& file, const std::string& other) {
      views_.Post([this, view, done, file, other] {
        --viewing_;
        Answer(done, [&] { return View(view, file, other); });
      });
    };
    const auto found = [this, view, refuse, look](const RunToCopy& run) {
      if (run.error != Error::kOk) return refuse(run);
      if (view.with.empty()) return look(run.file.string(), "");
      runs_.Open(view.with, [refuse, look, file = run.file.string()](const RunToCopy& other) {
        other.error == Error::kOk ? look(file, other.file.string()) : refuse(other);
      });
    };
    if (!view.run.empty()) return runs_.Open(view.run, found);
    const std::optional<PlaybackStatus> playback = run_.playback();
    found(playback ? RunToCopy{Error::kOk, {}, playback->file}
                   : RunToCopy{Error::kNotPossible, kNotPlayingText, {}});
  };
  return files;
}

HttpAnswer PageServices::View(const RunView& view, const std::string& file, const std::string& other) {
  std::string error;
  const OpenRecording open = OpenOn(path_);
  const std::shared_ptr<RunReader> run = open(file, error);
  if (run == nullptr) return ErrorAnswer(409, error);
  if (view.what == "timeline") return TimelineOf(*run);
  if (view.what == "scene") return SceneOf(*run);
  if (view.what == "poses") return PosesOf(*run, view.rate_hz, stopping_.get_token());
  if (view.what == "table") return TableOf(*run, view.robot, view.points, stopping_.get_token());
  const std::shared_ptr<RunReader> second = open(other, error);
  return second == nullptr ? ErrorAnswer(409, error) : PartingOf(*run, *second, replay_);
}

void PageServices::Check(const WebFile& file, const WebFiles::Done& done) {
  Answer(done, [&] {
    Diagnostics diagnostics;
    RobotLibrary robots(path_);
    const std::string extension = ToLower(std::filesystem::path(file.name).extension().string());
    if (extension != ".world" && extension != ".sdf" && extension != ".urdf") {
      const std::string name = file.name.empty() ? "(text)" : file.name;
      const Checked checked = CheckScenarioText(file.text, name, robots, diagnostics);
      return JsonAnswer(JsonText(Report(checked, diagnostics, name, name)));
    }
    if (const std::string objection = Uploads::Objection(file.name, file.text); !objection.empty())
      return ErrorAnswer(400, objection);
    const std::string scratch = uploads_.Scratch(file.name, file.text).string();
    if (scratch.empty()) return ErrorAnswer(507, "there is no room to look into the file");
    const Checked checked = CheckFile(scratch, robots, diagnostics);
    std::filesystem::remove(scratch);
    return JsonAnswer(JsonText(Report(checked, diagnostics, scratch, file.name)));
  });
}

void PageServices::Keep(const WebFile& file, const WebFiles::Done& done) {
  Answer(done, [&] {
    const Upload upload = uploads_.Keep(file.name, file.text);
    if (upload.status != 200) return ErrorAnswer(upload.status, upload.text);
    Diagnostics diagnostics;
    RobotLibrary robots(path_);
    const Checked checked = CheckFile(upload.file.string(), robots, diagnostics);
    json::object said = Report(checked, diagnostics, upload.file.string(), file.name);
    if (diagnostics.has_errors()) {
      uploads_.Remove(upload);
    } else {
      said["kind"] = upload.kind;
      said["name"] = upload.name;
      said["load"] = LoadOf(upload);
    }
    return JsonAnswer(JsonText(said));
  });
}

}  // namespace coopdyn
