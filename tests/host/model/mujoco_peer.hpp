// MuJoCo as a peer: a model from text, and its accelerations.
#pragma once

#ifdef FURCULA_MUJOCO
#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace furcula::test {

class MujocoPeer {
 public:
  /// A URDF or MJCF text. Contacts, friction loss and joint limits are off. @throws std::runtime_error.
  explicit MujocoPeer(std::string_view text) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(text.size()));
    text.copy(static_cast<char*>(files->filedata[0]), text.size());
    char error[1000] = "";
    model_.reset(mj_loadXML("robot.xml", files.get(), error, sizeof error));
    mj_deleteVFS(files.get());
    begin(error);
  }
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
  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

}  // namespace furcula::test
#endif
