// MuJoCo as a peer: a model from text, and its accelerations.
#pragma once

#ifdef FURCULA_MUJOCO
#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace furcula::test {

struct MujocoDelete {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using MujocoModel = std::unique_ptr<mjModel, MujocoDelete>;
using MujocoData = std::unique_ptr<mjData, MujocoDelete>;

/// A URDF or MJCF text. @throws std::runtime_error with what MuJoCo says.
inline MujocoModel mujoco_model(std::string_view text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(text.size()));
  text.copy(static_cast<char*>(files->filedata[0]), text.size());
  char error[1000] = "";
  MujocoModel model(mj_loadXML("robot.xml", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

class MujocoPeer {
 public:
  /// A URDF or MJCF text. Contacts, friction loss and joint limits are off. @throws std::runtime_error.
  explicit MujocoPeer(std::string_view text) : model_(mujoco_model(text)) { begin(""); }
  /// A file, with what it includes.
  static MujocoPeer of_file(const std::string& path) {
    MujocoPeer peer;
    char error[1000] = "";
    peer.model_.reset(mj_loadXML(path.c_str(), nullptr, error, sizeof error));
    peer.begin(error);
    return peer;
  }

  const mjModel& model() const { return *model_; }
  mjModel& model() { return *model_; }
  mjData& data() const { return *data_; }
  /// Of a joint in qpos; each has one number here.
  std::size_t place(const std::string& joint) const {
    const int id = mj_name2id(model_.get(), mjOBJ_JOINT, joint.c_str());
    if (id < 0) throw std::runtime_error("MuJoCo has no joint " + joint);
    return static_cast<std::size_t>(model_->jnt_dofadr[id]);
  }
  void forward() const { mj_forward(model_.get(), data_.get()); }

 private:
  MujocoPeer() = default;
  void begin(const char* error) {
    if (!model_) throw std::runtime_error(std::string("MuJoCo: ") + error);
    model_->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_CONSTRAINT;
    data_.reset(mj_makeData(model_.get()));
  }
  MujocoModel model_;
  MujocoData data_;
};

}  // namespace furcula::test
#endif
