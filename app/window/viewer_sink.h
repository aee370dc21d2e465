/// app/window/viewer_sink.h: the pictures of a run that a window shows. Internal to app/window.
///   Everything is done by the drawing thread, which owns the renderer.
///   Errors  as the run's own sink; unavailable: the window has gone.   Thread  run.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/window/viewer.h"

namespace burrhole {

/// The sink that a run sees: everything is done by the drawing thread.
class Viewer::Sink final : public PictureSink {
 public:
  explicit Sink(Viewer& viewer) : viewer_(&viewer) {}

  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    return viewer_->call([&] {
      viewer_->texels_.clear();  // of an earlier run of the same session
      viewer_->bone_changed_ = true;
      viewer_->tool_look_ = tool;
      viewer_->slices_stale_ = true;
      viewer_->note_ = volume.note;
      return own().start(volume, tool);
    });
  }
  void update(const TexelBox& texels) override {
    viewer_->post([v = viewer_, texels] { v->texels_.push_back(texels); });
  }
  Status move_detail(const DetailView& view) override {
    return viewer_->call([&] {
      viewer_->send_texels();
      viewer_->slices_stale_ = true;
      return own().move_detail(view);
    });
  }
  Status change_tool(const TriangleMesh& tool) override {
    return viewer_->call([&] {
      viewer_->bone_changed_ = true;
      viewer_->tool_look_ = tool;
      viewer_->slices_stale_ = true;
      return own().change_tool(tool);
    });
  }
  Status set_added(const std::shared_ptr<const AddedMesh>& mesh) override {
    viewer_->post([v = viewer_, mesh] {
      v->added_changed_ = true;
      if (Status set = v->parts_.sink->set_added(mesh); !set) v->state_->say("What effects show cannot be drawn: " + set.error().text(), true);
    });
    return {};
  }
  void forget() override {
    viewer_->post([v = viewer_] {
      v->send_texels();
      v->grown_ = true;
    });
  }
  Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) override {
    return viewer_->call([&] {
      viewer_->send_texels();
      // A driver may refuse new pictures once its display is lost. The run still writes its other results.
      const auto passes = [this](Status done) { return !done && viewer_->window_->is_lost() ? Status() : std::move(done); };
      if (Status set = viewer_->restore_run_quality(); !set) return passes(std::move(set));
      Status drawn = passes(own().draw(name, view, width, height, hash));
      viewer_->quality_ = viewer_->run_quality_ = own().display().quality;  // a budget has chosen it now
      return drawn;
    });
  }
  Result<std::vector<std::string>> files() override {
    std::optional<Result<std::vector<std::string>>> out;
    const Status called = viewer_->call([&] {
      out.emplace(own().files());
      return Status();
    });
    if (!called) return called.error();
    return *out;
  }
  std::string driver() const override {
    std::string out;
    (void)viewer_->call([&] {
      out = own().driver();
      return Status();
    });
    return out;
  }
  RunSummary::Display display() const override {
    RunSummary::Display out;
    (void)viewer_->call([&] {
      out = own().display();
      return Status();
    });
    return out;
  }

 private:
  [[nodiscard]] PictureSink& own() const { return *viewer_->parts_.sink; }
  Viewer* viewer_;
};

}  // namespace burrhole
