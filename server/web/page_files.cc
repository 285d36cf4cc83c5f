// SPDX-License-Identifier: MIT
#include "server/web/page_files.h"

#include <boost/json.hpp>

#include "protocol/codec.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

constexpr std::size_t kMaxFileNameBytes = 255;

/// The string at `key`; empty if missing. Sets `error` if it is not clean UTF-8.
std::string TextOf(const json::object& object, std::string_view key, std::string& error) {
  const json::value* value = object.if_contains(key);
  if (value == nullptr) return {};
  if (!value->is_string() || !IsCleanUtf8(std::string_view(value->get_string()))) {
    error = "\"" + std::string(key) + "\" must be UTF-8 text without NUL";
    return {};
  }
  return std::string(value->get_string());
}

const HttpAnswer& NoFiles() {
  static const HttpAnswer kNone = ErrorAnswer(404, "this daemon has no such files");
  return kNone;
}

}  // namespace

PageFileRead ReadPageFile(std::string_view text) {
  PageFileRead read;
  boost::system::error_code failed;
  const json::value value = json::parse(text, failed);
  if (failed || !value.is_object()) {
    read.error = R"(send a JSON object: {"name":"my.scenario","text":"…"})";
    return read;
  }
  const json::object& object = value.get_object();
  read.file.name = TextOf(object, "name", read.error);
  read.file.text = TextOf(object, "text", read.error);
  read.token = TextOf(object, "token", read.error);
  if (!read.error.empty()) return read;
  if (read.file.name.empty() || !object.contains("text")) {
    read.error = R"(give the file's name and text: {"name":"my.scenario","text":"…"})";
  } else if (read.file.name.size() > kMaxFileNameBytes) {
    read.error = "the name of the file is too long";
  }
  return read;
}

void PageFiles::Check(WebFile file, Done done) {
  const Done answer = answers_.Expect(std::move(done));
  files_.check ? files_.check(std::move(file), answer) : answer(NoFiles());
}

void PageFiles::Upload(WebFile file, Done done) {
  const Done answer = answers_.Expect(std::move(done));
  files_.upload ? files_.upload(std::move(file), answer) : answer(NoFiles());
}

void PageFiles::Text(const std::string& kind, const std::string& name, Done done) {
  const Done answer = answers_.Expect(std::move(done));
  files_.text ? files_.text(kind, name, answer) : answer(NoFiles());
}

void PageFiles::Run(const RunView& view, Done done) {
  const Done answer = answers_.Expect(std::move(done));
  files_.run ? files_.run(view, answer) : answer(NoFiles());
}

void PageFiles::Gallery(Done done) {
  const Done answer = answers_.Expect(std::move(done));
  files_.gallery ? files_.gallery(answer) : answer(NoFiles());
}

void PageFiles::Thumb(const std::string& kind, const std::string& name, Done done) {
  const Done answer = answers_.Expect(std::move(done));
  files_.thumb ? files_.thumb(kind, name, answer) : answer(NoFiles());
}

}  // namespace coopdyn
