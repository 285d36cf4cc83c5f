// SPDX-License-Identifier: MIT
#include "server/controllers/plugin.h"

#include <dlfcn.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <string_view>

#include "server/base/printable.h"

namespace coopdyn {

namespace {

constexpr std::uint32_t kAllReadings = COOPDYN_DISTANCES | COOPDYN_POSE | COOPDYN_CHANNELS | COOPDYN_TARGETS |
                                       COOPDYN_NEIGHBOURS | COOPDYN_MESSAGES | COOPDYN_COMPASS |
                                       COOPDYN_SETPOINTS | COOPDYN_SUPPORT | COOPDYN_MOTION |
                                       COOPDYN_SENSORS | COOPDYN_WORLD | COOPDYN_MAPPED;

bool IsOptionName(std::string_view name) {
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

/// Copies a text into a field; throws PluginError if it does not fit.
template <std::size_t kSize>
void TakeText(char (&to)[kSize], const char* text, const std::string& what) {
  const std::size_t length = text == nullptr ? 0 : strnlen(text, kSize);
  if (length == kSize) throw PluginError(fmt::format("{} is longer than {} bytes", what, kSize - 1));
  CopyText(to, kSize, {text == nullptr ? "" : text, length});
}

void TakeOption(const coopdyn_option& raw, std::size_t index, OptionRecord& option) {
  TakeText(option.name, raw.name, fmt::format("the name of option {}", index + 1));
  if (!IsOptionName(option.name)) {
    throw PluginError(
        fmt::format("option {} needs a name of a-z, 0-9 and _ that starts with a letter", index + 1));
  }
  TakeText(option.help, raw.help, fmt::format("the help of option {}", option.name));
  option.value = raw.value;
  option.min = raw.min;
  option.max = raw.max;
  if (!std::isfinite(raw.value) || !(raw.min <= raw.value && raw.value <= raw.max)) {
    throw PluginError(fmt::format("option {}: its value {} must be from min {} to max {}", option.name,
                                  raw.value, raw.min, raw.max));
  }
}

void TakeDescription(const coopdyn_description* raw, FileResult& result) {
  if (raw == nullptr) throw PluginError("describe() returned NULL: return a coopdyn_description");
  TakeText(result.help, raw->help, "the help in describe()");
  if ((raw->readings & ~kAllReadings) != 0) {
    throw PluginError(
        fmt::format("describe() asks for readings {:#x} that do not exist: add up COOPDYN_DISTANCES, ...",
                    raw->readings & ~kAllReadings));
  }
  if ((raw->readings & COOPDYN_WORLD) != 0 && raw->readings != COOPDYN_WORLD) {
    throw PluginError(
        "describe() asks for COOPDYN_WORLD and other readings: a supervisor has no robot, so it takes "
        "COOPDYN_WORLD alone");
  }
  constexpr std::uint32_t kBoth = COOPDYN_MAPPED | COOPDYN_SETPOINTS;
  if ((raw->readings & kBoth) == kBoth) {
    throw PluginError(
        "describe() asks for COOPDYN_MAPPED and COOPDYN_SETPOINTS: the motors of the channel drive the "
        "robot, "
        "or set-points do");
  }
  if (raw->state_size > COOPDYN_MAX_STATE) {
    throw PluginError(
        fmt::format("state_size in describe() is {}: at most {} bytes", raw->state_size, COOPDYN_MAX_STATE));
  }
  const bool takes_any = raw->option_count == COOPDYN_ANY_OPTIONS;
  if (raw->option_count > COOPDYN_MAX_OPTIONS && !takes_any) {
    throw PluginError(
        fmt::format("option_count in describe() is {}: at most {}", raw->option_count, COOPDYN_MAX_OPTIONS));
  }
  if (raw->option_count > 0 && !takes_any && raw->options == nullptr) {
    throw PluginError("options in describe() is NULL though option_count is not 0");
  }
  for (std::size_t i = 0; !takes_any && i < raw->option_count; ++i) {
    TakeOption(raw->options[i], i, result.options[i]);
    for (std::size_t k = 0; k < i; ++k) {
      if (std::strcmp(result.options[k].name, result.options[i].name) != 0) continue;
      throw PluginError(fmt::format("option {} is described twice", result.options[i].name));
    }
  }
  // The structs of older controllers lack this field.
  if ((raw->readings & COOPDYN_SENSORS) != 0) {
    TakeText(result.sensors, raw->sensors, "sensors in describe()");
  }
  result.readings = raw->readings;
  result.state_size = raw->state_size;
  result.option_count = raw->option_count;
}

void CheckFunctions(const coopdyn_controller& functions) {
  const auto need = [](bool there, const char* name) {
    if (!there) throw PluginError(fmt::format("its function {} is NULL", name));
  };
  need(functions.describe != nullptr, "describe");
  need(functions.create != nullptr, "create");
  need(functions.reset != nullptr, "reset");
  need(functions.step != nullptr, "step");
  need(functions.destroy != nullptr, "destroy");
}

using EntryFunction = const coopdyn_controller* (*)();

}  // namespace

void CopyText(char* to, std::size_t size, const std::string& text) {
  const std::string printable = Printable(text);
  const std::size_t length = std::min(size - 1, printable.size());
  std::memcpy(to, printable.data(), length);
  to[length] = '\0';
}

void Plugin::Close::operator()(void* handle) const {
  dlclose(handle);
}

Plugin::Plugin(const std::string& path, FileResult& result)
    : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) {
    const char* error = dlerror();
    throw PluginError(fmt::format("it cannot be loaded ({})", error == nullptr ? "no reason given" : error));
  }
  const auto entry = reinterpret_cast<EntryFunction>(dlsym(handle_.get(), COOPDYN_CONTROLLER_ENTRY));
  if (entry == nullptr) {
    throw PluginError("it does not export " COOPDYN_CONTROLLER_ENTRY "(): see controller.h");
  }
  try {
    const coopdyn_controller* found = entry();
    if (found == nullptr) throw PluginError(COOPDYN_CONTROLLER_ENTRY "() returned NULL");
    if (found->version != COOPDYN_CONTROLLER_VERSION) {
      throw PluginError(
          fmt::format("it was built for version {} of controller.h, this daemon has version {}: build it "
                      "again with the controller.h of this daemon",
                      found->version, COOPDYN_CONTROLLER_VERSION));
    }
    functions_ = *found;
    CheckFunctions(functions_);
    TakeDescription(functions_.describe(), result);
  } catch (const PluginError&) {
    throw;
  } catch (const std::exception& exception) {
    throw PluginError(fmt::format("its describe() threw an exception ({})", exception.what()));
  } catch (...) {
    throw PluginError("its describe() threw an exception");
  }
  state_size_ = result.state_size;
  gives_setpoints_ = (result.readings & COOPDYN_SETPOINTS) != 0;
  supervises_ = (result.readings & COOPDYN_WORLD) != 0;
  maps_ = (result.readings & COOPDYN_MAPPED) != 0;
  if (state_size_ > 0 && (functions_.save == nullptr || functions_.restore == nullptr)) {
    throw PluginError("its functions save and restore may be NULL only if state_size is 0");
  }
}

}  // namespace coopdyn
