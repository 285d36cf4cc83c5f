// SPDX-License-Identifier: MIT
#include "server/mjcf/load.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/words.h"

namespace coopdyn::mjcf {

namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr int kMaxRounds = 500;  // each round mends one error
constexpr int kMaxIncludeDepth = 10, kMaxIncludes = 1000;
constexpr std::size_t kMaxText = 64u << 20;

std::string Between(const std::string& text, const std::string& start, const std::string& end) {
  const std::size_t at = text.find(start);
  if (at == std::string::npos) return {};
  const std::size_t from = at + start.size(), to = text.find(end, from);
  return text.substr(from, to == std::string::npos ? to : to - from);
}

std::string AttributeOf(const XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

/// Calls visit() for `element` and all its descendants.
void ForAll(XMLElement& element, const std::function<void(XMLElement&)>& visit) {
  visit(element);
  for (XMLElement* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    ForAll(*child, visit);
}

std::string ParentName(const XMLElement& element) {
  const tinyxml2::XMLNode* const parent = element.Parent();
  return parent == nullptr || parent->ToElement() == nullptr ? "" : parent->ToElement()->Name();
}

/// Replaces line ends in attributes: libmujoco 2.2.2 counts them among a keyframe's numbers.
void JoinLines(XMLElement& element) {
  for (const auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    std::string value = one->Value();
    if (value.find_first_of("\n\t") == std::string::npos) continue;
    std::ranges::replace_if(
        value, [](char c) { return c == '\n' || c == '\t'; }, ' ');
    element.SetAttribute(one->Name(), std::string(Trim(value)).c_str());
  }
}

/// Mends a document until libmujoco accepts it.
class Mender {
 public:
  Mender(const std::string& file, Words& words) : file_(file), words_(words) {}

  Loaded Load() {
    Loaded loaded;
    if (document_.LoadFile(file_.c_str()) != tinyxml2::XML_SUCCESS || document_.RootElement() == nullptr)
      return loaded;
    if (!Expand(*document_.RootElement(), fs::path(file_).parent_path(), 0)) return loaded;
    Prepare(*document_.RootElement());
    for (int round = 0; round < kMaxRounds; ++round) {
      // Printing puts each element on its own line, by which libmujoco's errors identify it.
      tinyxml2::XMLPrinter printer;
      document_.Print(&printer);
      const std::string text = printer.CStr();
      if (text.size() > kMaxText || document_.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS)
        break;
      std::array<char, 1000> error{};
      loaded.model.reset(LoadText(text, error));
      if (loaded.model != nullptr) {
        loaded.unread_meshes = std::move(unread_meshes_);
        loaded.has_joint_limits = has_joint_limits_;
        break;
      }
      if (!Mend(error.data())) {
        loaded.why = error.data();
        break;
      }
    }
    return loaded;
  }

 private:
  mjModel* LoadText(const std::string& text, std::array<char, 1000>& error) {
    const auto vfs = std::make_unique<mjVFS>();
    mj_defaultVFS(vfs.get());
    const std::string name = fs::path(file_).filename().string();
    mjModel* model = nullptr;
    if (mj_makeEmptyFileVFS(vfs.get(), name.c_str(), static_cast<int>(text.size())) == 0) {
      std::memcpy(vfs->filedata[0], text.data(), text.size());
      model = mj_loadXML(file_.c_str(), vfs.get(), error.data(), static_cast<int>(error.size()));
    }
    mj_deleteVFS(vfs.get());
    return model;
  }

  /// Replaces each <include> by the content of its file. False if a file cannot be read.
  bool Expand(XMLElement& element, const fs::path& folder, int depth) {
    for (XMLElement* child = element.FirstChildElement(); child != nullptr;) {
      XMLElement* const next = child->NextSiblingElement();
      if (std::string_view(child->Name()) != "include") {
        if (!Expand(*child, folder, depth)) return false;
        child = next;
        continue;
      }
      const char* const name = child->Attribute("file");
      if (name == nullptr || depth >= kMaxIncludeDepth || ++includes_ > kMaxIncludes) return false;
      tinyxml2::XMLDocument included;
      fs::path path = fs::path(file_).parent_path() / name;
      std::error_code code;
      if (!fs::exists(path, code)) path = folder / name;
      if (included.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS || included.RootElement() == nullptr)
        return false;
      if (!Expand(*included.RootElement(), path.parent_path(), depth + 1)) return false;
      tinyxml2::XMLNode* after = child;
      for (const XMLElement* one = included.RootElement()->FirstChildElement(); one != nullptr;
           one = one->NextSiblingElement())
        after = element.InsertAfterChild(after, one->DeepClone(&document_));
      element.DeleteChild(child);
      child = next;
    }
    return true;
  }

  /// Sets defaults of newer versions and removes unused parts.
  void Prepare(XMLElement& root) {
    std::vector<XMLElement*> unused;
    ForAll(root, [&unused](XMLElement& element) {
      const std::string_view name = element.Name();
      JoinLines(element);
      if (name == "material") element.DeleteAttribute("texture");
      if (name == "compiler" && element.Attribute("assetdir") != nullptr) {
        for (const char* key : {"meshdir", "texturedir"}) {
          if (element.Attribute(key) == nullptr) element.SetAttribute(key, element.Attribute("assetdir"));
        }
        element.DeleteAttribute("assetdir");
      }
      const bool is_asset = ParentName(element) == "asset";
      if (is_asset && (name == "texture" || name == "skin")) unused.push_back(&element);
    });
    for (XMLElement* one : unused) one->Parent()->DeleteChild(one);
    Compiler().SetAttribute("autolimits", "true");
  }

  XMLElement& Compiler() {
    XMLElement& root = *document_.RootElement();
    if (XMLElement* const known = root.FirstChildElement("compiler")) return *known;
    XMLElement* const made = document_.NewElement("compiler");
    root.InsertFirstChild(made);
    return *made;
  }

  XMLElement* ElementAt(int line) {
    XMLElement* found = nullptr;
    ForAll(*document_.RootElement(), [&](XMLElement& element) {
      if (element.GetLineNum() == line) found = &element;
    });
    return found;
  }

  /// Calls act() for all elements whose name and parent's name are those of `like`.
  void ForAllLike(const XMLElement& like, const std::function<void(XMLElement&)>& act) {
    const std::string name = like.Name(), parent = ParentName(like);
    ForAll(*document_.RootElement(), [&](XMLElement& element) {
      if (element.Name() == name && ParentName(element) == parent) act(element);
    });
  }

  /// Changes the element that `error` names. False if that is impossible.
  bool Mend(const std::string& error) {
    if (error.find("balanceinertia") != std::string::npos &&
        Compiler().Attribute("balanceinertia") == nullptr) {
      Compiler().SetAttribute("balanceinertia", "true");
      words_.Say("a body has impossible moments of inertia: libmujoco balances them", false);
      return true;
    }
    if (const std::string number = Between(error, "key ", ":");
        error.find("size, expected") != std::string::npos)
      return LeaveOutKey(std::atoi(number.c_str()), error);
    if (error.find("stateless actuators must come before") != std::string::npos) return SortActuators();
    const std::size_t at = error.rfind("line ");
    int line = 0;
    if (at != std::string::npos)
      line = std::atoi(error.c_str() + at + (error.compare(at, 7, "line = ") == 0 ? 7 : 5));
    XMLElement* const element = ElementAt(line);
    if (element == nullptr || element == document_.RootElement()) return false;
    const std::string what = "<" + std::string(element->Name()) + ">";
    if (const std::string key = Between(error, "unrecognized attribute: '", "'"); !key.empty()) {
      LeaveOutAttribute(*element, key);
      return true;
    }
    if (error.find("unrecognized element") != std::string::npos) {
      LeaveOutElements(*element);
      return true;
    }
    if (const std::string word = Between(error, "invalid keyword: '", "'"); !word.empty())
      return LeaveOutWord(*element, word);
    if (const std::string key = Between(error, "attribute '", "' has too much data");
        element->Attribute(key.c_str()))
      return LeaveOutLastWord(*element, key);
    if (ParentName(*element) == "asset" && std::string_view(element->Name()) == "mesh")
      return PutBox(*element, error);
    // Nothing refers to elements of these sections, so the element can be left out.
    for (const char* part : {"sensor", "keyframe", "custom", "contact", "actuator", "equality", "tendon"}) {
      if (ParentName(*element) != part) continue;
      words_.Say("a " + what + " is left out, as libmujoco says: " + error.substr(0, error.find('\n')));
      element->Parent()->DeleteChild(element);
      return true;
    }
    return false;
  }

  /// Moves actuators with a state to the end: newer versions accept any order. False if already done.
  bool SortActuators() {
    if (std::exchange(has_sorted_, true)) return false;
    std::vector<XMLElement*> with_state;
    ForAll(*document_.RootElement(), [&with_state](XMLElement& element) {
      const std::string_view name = element.Name();
      const std::string type = AttributeOf(element, "dyntype");
      const bool has_state = name == "muscle" || name == "cylinder" || (!type.empty() && type != "none");
      if (ParentName(element) == "actuator" && has_state) with_state.push_back(&element);
    });
    for (XMLElement* one : with_state) one->Parent()->InsertEndChild(one);  // moves it
    return !with_state.empty();
  }

  /// Removes the last number of an attribute: newer versions accept more numbers.
  bool LeaveOutLastWord(XMLElement& element, const std::string& key) {
    const std::string value = AttributeOf(element, key.c_str());
    const std::size_t end = value.find_last_of(' ');
    if (end == std::string::npos) return false;
    words_.Say("'" + key + "' of <" + element.Name() + "> has more numbers than libmujoco " +
                   mj_versionString() + " knows: the first count",
               false);
    element.SetAttribute(key.c_str(), std::string(Trim(value.substr(0, end))).c_str());
    return true;
  }

  bool LeaveOutKey(int number, const std::string& error) {
    std::vector<XMLElement*> keys;
    ForAll(*document_.RootElement(), [&keys](XMLElement& element) {
      if (std::string_view(element.Name()) == "key") keys.push_back(&element);
    });
    if (number < 0 || static_cast<std::size_t>(number) >= keys.size()) return false;
    words_.Say("a keyframe is left out, as libmujoco says: " + error.substr(0, error.find('\n')));
    XMLElement* const key = keys[static_cast<std::size_t>(number)];
    key->Parent()->DeleteChild(key);
    return true;
  }

  void LeaveOutAttribute(XMLElement& element, const std::string& key) {
    const std::string what = "<" + std::string(element.Name()) + ">";
    // Keep a joint's force limit as user data.
    const bool is_limit = std::string_view(element.Name()) == "joint" && key == "actuatorfrcrange";
    if (is_limit) {
      XMLElement& root = *document_.RootElement();
      XMLElement* size = root.FirstChildElement("size");
      if (size == nullptr) size = root.InsertFirstChild(document_.NewElement("size"))->ToElement();
      size->SetAttribute("nuser_jnt", 2);
      has_joint_limits_ = true;
    } else if (key != "actuatorfrclimited") {
      words_.Say(
          "'" + key + "' of " + what + " is not known to libmujoco " + mj_versionString() + ", and left out",
          false);
    }
    ForAllLike(element, [&](XMLElement& one) {
      const std::string value = AttributeOf(one, key.c_str());
      if (is_limit && !value.empty() && one.Attribute("user") == nullptr)
        one.SetAttribute("user", value.c_str());
      one.DeleteAttribute(key.c_str());
    });
  }

  void LeaveOutElements(XMLElement& element) {
    const std::string name = element.Name(), parent = ParentName(element);
    std::vector<XMLElement*> all;
    ForAllLike(element, [&](XMLElement& one) { all.push_back(&one); });
    std::ranges::reverse(all);  // inner elements first
    bool is_left_out = false;
    for (XMLElement* one : all) {
      const bool has_own = one->FirstChildElement("joint") != nullptr ||
                           one->FirstChildElement("freejoint") != nullptr ||
                           one->FirstChildElement("inertial") != nullptr;
      if (name == "frame" && !has_own) {
        one->SetName("body");  // without joints, so fixed to its parent
        continue;
      }
      one->Parent()->DeleteChild(one);
      is_left_out = true;
    }
    if (is_left_out)
      words_.Say("<" + name + "> in <" + parent + "> is not known to libmujoco " + mj_versionString() +
                     ", and left out",
                 false);
  }

  bool LeaveOutWord(XMLElement& element, const std::string& word) {
    std::string key;
    for (const auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
      if (one->Value() == word) key = one->Name();
    }
    if (key.empty()) return false;
    const std::string name = element.Name();
    words_.Say("'" + word + "' of '" + key + "' of <" + name + "> is not known to libmujoco " +
                   mj_versionString() + ", and left out",
               false);
    std::vector<XMLElement*> all;
    ForAllLike(element, [&](XMLElement& one) {
      if (AttributeOf(one, key.c_str()) == word) all.push_back(&one);
    });
    for (XMLElement* one : all) {
      if (name == "geom" && key == "type") {
        one->Parent()->DeleteChild(one);
      } else {
        one->DeleteAttribute(key.c_str());
      }
    }
    return true;
  }

  /// Replaces a mesh by a box whose frame is that of the mesh's file.
  bool PutBox(XMLElement& mesh, const std::string& error) {
    const std::string file = AttributeOf(mesh, "file");
    if (file.empty()) return false;
    const std::string stem = fs::path(file).stem().string();
    const std::string name = mesh.Attribute("name") == nullptr ? stem : AttributeOf(mesh, "name");
    std::string folder;
    for (const XMLElement* one = document_.RootElement()->FirstChildElement("compiler"); one != nullptr;
         one = one->NextSiblingElement("compiler")) {
      if (one->Attribute("meshdir") != nullptr) folder = one->Attribute("meshdir");
    }
    const fs::path written = fs::path(folder) / file, found = fs::path(file_).parent_path() / written;
    std::error_code code;
    const bool is_there = fs::exists(found, code),
               is_readable = written.extension() != ".msh";  // MuJoCo's own format
    unread_meshes_[name] = {is_readable ? written.string() : "", is_there ? found.string() : "",
                            AttributeOf(mesh, "scale")};
    if (!is_readable || is_there)  // coopdyn itself reports missing files
      words_.Say("mesh '" + name + "' is " + (is_readable ? "read by coopdyn itself" : "left out") +
                 ", as libmujoco says: " + error.substr(0, error.find('\n')));
    for (const char* key : {"file", "scale", "refpos", "refquat"}) mesh.DeleteAttribute(key);
    mesh.SetAttribute("name", name.c_str());
    mesh.SetAttribute("vertex",
                      "-.01 -.02 -.03 .01 -.02 -.03 -.01 .02 -.03 .01 .02 -.03 "
                      "-.01 -.02 .03 .01 -.02 .03 -.01 .02 .03 .01 .02 .03");
    return true;
  }

  const std::string file_;
  Words& words_;
  tinyxml2::XMLDocument document_;
  int includes_ = 0;
  bool has_joint_limits_ = false, has_sorted_ = false;
  std::map<std::string, UnreadMesh> unread_meshes_;
};

/// Removes the parts that <flag> disables.
void SwitchOff(mjModel& m) {
  const auto is_off = [&m](int flag) { return (m.opt.disableflags & flag) != 0; };
  if (is_off(mjDSBL_CONTACT)) {
    std::fill_n(m.geom_contype, m.ngeom, 0);
    std::fill_n(m.geom_conaffinity, m.ngeom, 0);
  }
  if (is_off(mjDSBL_PASSIVE)) {
    std::fill_n(m.jnt_stiffness, m.njnt, 0.0);
    std::fill_n(m.dof_damping, m.nv, 0.0);
  }
  if (is_off(mjDSBL_LIMIT)) std::fill_n(m.jnt_limited, m.njnt, mjtByte{0});
  if (is_off(mjDSBL_FRICTIONLOSS)) std::fill_n(m.dof_frictionloss, m.nv, 0.0);
  if (is_off(mjDSBL_EQUALITY)) std::fill_n(m.eq_active, m.neq, mjtByte{0});
}

}  // namespace

Loaded Load(const std::string& file, Words& words) {
  Loaded loaded;
  std::array<char, 1000> error{};
  loaded.model.reset(mj_loadXML(file.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (loaded.model != nullptr) {
    SwitchOff(*loaded.model);
    return loaded;
  }
  Loaded mended = Mender(file, words).Load();
  if (mended.model != nullptr) SwitchOff(*mended.model);
  // Report the error of the unchanged file first: line numbers of the mended document are not the file's.
  const std::string last = mended.why.substr(0, mended.why.find('\n'));
  mended.why = error.data();
  if (!last.empty() && !mended.why.starts_with(last)) mended.why += "\nWithout that: " + last;
  return mended;
}

}  // namespace coopdyn::mjcf
