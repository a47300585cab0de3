// The files that are embedded into the program when it is built, so that a report needs no other file.
#pragma once

#include <string_view>

namespace furcula::report::assets {

extern const std::string_view dygraphs_script;   ///< dygraph.min.js, with its licence comment
extern const std::string_view dygraphs_style;    ///< dygraph.min.css
extern const std::string_view dygraphs_licence;  ///< the notice that must go with it
extern const std::string_view page_style;        ///< assets/report.css
extern const std::string_view page_script;       ///< assets/report.js
extern const std::string_view canvas_script;     ///< assets/canvas.js
extern const std::string_view robot_script;      ///< assets/robot.js
extern const std::string_view leg_script;        ///< assets/leg.js
extern const std::string_view walk_script;       ///< assets/walk.js

}  // namespace furcula::report::assets
