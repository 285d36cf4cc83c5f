// SPDX-License-Identifier: MIT
#include "server/controllers/plugin.h"

#include <dlfcn.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <utility>

#include "server/controllers/shared_layout.h"

namespace coopdyn {

namespace {

constexpr std::uint32_t kAllReadings = COOPDYN_DISTANCES | COOPDYN_POSE | COOPDYN_WHEELS | COOPDYN_TARGETS |
                                       COOPDYN_NEIGHBOURS | COOPDYN_MESSAGES;

bool IsOptionName(const std::string& name) {
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

/// A text of at most `size` - 1 bytes; one that is longer is no name and no line of help.
std::string TakeText(const char* text, std::size_t size, const std::string& what) {
  if (text == nullptr) return {};
  const std::size_t length = strnlen(text, size);
  if (length == size) throw PluginError(fmt::format("{} is longer than {} bytes", what, size - 1));
  return {text, length};
}

ControllerOption TakeOption(const coopdyn_option& raw, std::size_t index) {
  ControllerOption option;
  option.name = TakeText(raw.name, kNameSize, fmt::format("the name of option {}", index + 1));
  if (!IsOptionName(option.name)) {
    throw PluginError(
        fmt::format("option {} needs a name of a-z, 0-9 and _ that starts with a letter", index + 1));
  }
  option.help = TakeText(raw.help, kTextSize, "the help of option " + option.name);
  option.value = raw.value;
  option.min = raw.min;
  option.max = raw.max;
  if (!std::isfinite(raw.value) || !(raw.min <= raw.value && raw.value <= raw.max)) {
    throw PluginError(fmt::format("option {}: its value {} must be from min {} to max {}", option.name,
                                  raw.value, raw.min, raw.max));
  }
  return option;
}

ControllerDescription TakeDescription(const coopdyn_description* raw) {
  if (raw == nullptr) throw PluginError("describe() returned NULL: return a coopdyn_description");
  ControllerDescription description;
  description.help = TakeText(raw->help, kTextSize, "the help in describe()");
  description.readings = raw->readings;
  if ((raw->readings & ~kAllReadings) != 0) {
    throw PluginError(
        fmt::format("describe() asks for readings {:#x} that do not exist: add up COOPDYN_DISTANCES, ...",
                    raw->readings & ~kAllReadings));
  }
  description.state_size = raw->state_size;
  if (raw->state_size > COOPDYN_MAX_STATE) {
    throw PluginError(
        fmt::format("state_size in describe() is {}: at most {} bytes", raw->state_size, COOPDYN_MAX_STATE));
  }
  if (raw->option_count > COOPDYN_MAX_OPTIONS) {
    throw PluginError(
        fmt::format("option_count in describe() is {}: at most {}", raw->option_count, COOPDYN_MAX_OPTIONS));
  }
  if (raw->option_count > 0 && raw->options == nullptr) {
    throw PluginError("options in describe() is NULL though option_count is not 0");
  }
  for (std::size_t i = 0; i < raw->option_count; ++i) {
    ControllerOption option = TakeOption(raw->options[i], i);
    const auto same = [&option](const ControllerOption& other) { return other.name == option.name; };
    if (std::any_of(description.options.begin(), description.options.end(), same)) {
      throw PluginError("option " + option.name + " is described twice");
    }
    description.options.push_back(std::move(option));
  }
  return description;
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

using Entry = const coopdyn_controller* (*)();

/// The object's own code runs in here.
void Ask(Entry entry, coopdyn_controller& functions, ControllerDescription& description) {
  const coopdyn_controller* found = entry();
  if (found == nullptr) throw PluginError(COOPDYN_CONTROLLER_ENTRY "() returned NULL");
  if (found->version != COOPDYN_CONTROLLER_VERSION) {
    throw PluginError(
        fmt::format("it was built for version {} of controller.h, this daemon has version {}: build it "
                    "again with the controller.h of this daemon",
                    found->version, COOPDYN_CONTROLLER_VERSION));
  }
  functions = *found;
  CheckFunctions(functions);
  description = TakeDescription(functions.describe());
  if (description.state_size > 0 && (functions.save == nullptr || functions.restore == nullptr)) {
    throw PluginError("its functions save and restore may be NULL only if state_size is 0");
  }
}

}  // namespace

Plugin::Plugin(const std::string& path) {
  handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) {
    const char* error = dlerror();
    throw PluginError(fmt::format("it cannot be loaded ({})", error == nullptr ? "no reason given" : error));
  }
  try {
    const auto entry = reinterpret_cast<Entry>(dlsym(handle_, COOPDYN_CONTROLLER_ENTRY));
    if (entry == nullptr) {
      throw PluginError("it does not export " COOPDYN_CONTROLLER_ENTRY "(): see controller.h");
    }
    Ask(entry, functions_, description_);
  } catch (const PluginError&) {
    dlclose(handle_);
    throw;
  } catch (const std::exception& exception) {
    const std::string what = exception.what();  // it may live in what is closed
    dlclose(handle_);
    throw PluginError(fmt::format("its describe() threw an exception ({})", what));
  } catch (...) {
    dlclose(handle_);
    throw PluginError("its describe() threw an exception");
  }
}

Plugin::~Plugin() {
  if (handle_ != nullptr) dlclose(handle_);
}

Plugin::Plugin(Plugin&& other) noexcept
    : handle_(std::exchange(other.handle_, nullptr)),
      functions_(other.functions_),
      description_(std::move(other.description_)) {}

}  // namespace coopdyn
