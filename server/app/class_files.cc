// SPDX-License-Identifier: MIT
#include "server/app/class_files.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "server/model/text_file.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTokenDigits = 24;

std::vector<unsigned char> RandomBytes(std::size_t count) {
  std::vector<unsigned char> bytes(count);
  while (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
  }
  return bytes;
}

/// An error text.
std::string WriteOwn(const fs::path& file, const std::string& text) {
  const fs::path fresh = file.string() + ".new";
  const UniqueFd fd(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (fd) errno = ENOSPC;  // what a write that ends early means
  const bool written = fd && ::write(fd.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (!written || ::rename(fresh.c_str(), file.c_str()) != 0)
    return file.string() + " cannot be written: " + std::strerror(errno);
  return {};
}

}  // namespace

RandomDigits SystemRandom() {
  return {[](std::size_t count) {
            std::string digits;
            for (const unsigned char byte : RandomBytes(count)) digits += fmt::format("{:x}", byte & 15);
            return digits;
          },
          [](std::size_t count) {
            std::string digits;
            while (digits.size() < count) {
              const unsigned char byte = RandomBytes(1)[0];
              if (byte < 250) digits += static_cast<char>('0' + byte % 10);  // each digit is as likely
            }
            return digits;
          }};
}

fs::path RollFile(const fs::path& folder) {
  return folder / "class.csv";
}

std::optional<Roll> LoadRoll(const fs::path& file, Diagnostics& diagnostics, const Roll& known) {
  const std::optional<std::string> text = ReadTextFile(file.string(), {file.string(), 0}, diagnostics);
  if (!text) return std::nullopt;
  Roll roll = ReadRoll(*text, file.string(), SystemRandom(), diagnostics, known);
  if (diagnostics.has_errors()) return std::nullopt;
  return roll;
}

UniqueFd LockRoll(const fs::path& folder) {
  UniqueFd lock(::open((folder / "class.csv.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (lock) ::flock(lock.get(), LOCK_EX);
  return lock;
}

std::string SaveRoll(const fs::path& file, const Roll& roll) {
  return WriteOwn(file, roll.ToCsv());
}

std::string TeacherToken(const fs::path& folder, std::string& error) {
  const fs::path file = folder / "token";
  std::ifstream kept(file);
  std::string token;
  if (kept >> token && token.size() >= kTokenDigits) return token;
  token = SystemRandom().hex(kTokenDigits);
  error = WriteOwn(file, token + "\n");
  return error.empty() ? token : "";
}

}  // namespace coopdyn
