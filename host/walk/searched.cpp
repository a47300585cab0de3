#include "host/walk/searched.hpp"

#include "host/core/error.hpp"
#include "host/walk/postures.hpp"
#include "host/walk/walk_report.hpp"

namespace furcula::walk {

void require_posture(const Model& model, const RolloutOptions& rollout) {
  if (const std::string limit = limit_of_no_posture(model.robot, rollout); !limit.empty())
    throw core::DataError(model.file + ": " + limit);
}

Searched searched(const Model& model, const SearchOptions& options) {
  constexpr double kSearch = 0.98;  // of the time
  const auto told = [&](double fraction, const std::string& doing) {
    if (options.progress) options.progress(fraction, doing);
  };
  SearchOptions search = options;
  search.progress = [&](double fraction, const std::string& doing) { told(kSearch * fraction, doing); };
  Searched out;
  out.found = search_walk(model.robot, search);
  if (out.found.found)
    out.robustness = robustness_of(
        model.robot, options.rollout, out.found.walk, unseen_robots(model, options.rollout.mode),
        options.threads,
        [&](double fraction) { told(kSearch + (1.0 - kSearch) * fraction, "the walk again, with errors"); });
  return out;
}

std::vector<core::NewFile> files_of(const Model& model, const SearchOptions& options,
                                    const Searched& searched, const std::string& folder,
                                    const std::string& command) {
  const SearchResult& found = searched.found;
  const Walk walk = walk_of(model, options.rollout, found.walk);
  return {{folder + "/walk.json", to_json_text(found, searched.robustness, options, model)},
          {folder + "/report.html", render_walk_report(model, options.rollout, found.walk, found.rollout,
                                                       found.state.history, searched.robustness, command)},
          {folder + "/walk.toml", format_walk(walk)}};
}

}  // namespace furcula::walk
