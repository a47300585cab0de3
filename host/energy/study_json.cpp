#include "host/energy/study_json.hpp"

#include <nlohmann/json.hpp>

namespace furcula::energy {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json robot(const std::optional<Settled>& settled) {
  if (!settled) return nullptr;
  const HopEnergy& e = settled->energy;
  return {{"amplitude_nm", settled->amplitude_nm},
          {"apex_m", e.apex_m},
          {"mechanical_j", cost_j(e, Measure::mechanical)},
          {"electrical_j", cost_j(e, Measure::electrical)},
          {"motor_work_j", e.motor_work},
          {"motor_pushed_j", e.motor_pushed},
          {"motor_copper_j", e.motor_copper},
          {"coil_j", e.coil},
          {"lost_guide_j", e.guide_damping},
          {"lost_leg_j", e.leg_damping},
          {"lost_touchdown_j", e.touchdown},
          {"lost_stop_j", e.stop},
          {"lost_liftoff_j", e.liftoff},
          {"lost_clutch_friction_j", e.clutch_friction},
          {"lost_clutch_impacts_j", e.clutch_impacts},
          {"lost_coil_j", e.coil_heat},
          {"peak_torque_flight_nm", e.peak_torque_flight_nm},
          {"peak_torque_stance_nm", e.peak_torque_stance_nm},
          {"fold_m", e.fold_m},
          {"compression_m", e.compression_m},
          {"flight_s", e.flight_s}};
}

}  // namespace

std::string to_json_text(const Study& s) {
  Json out;
  out["schema"] = "furcula-energy/1";
  out["apex_m"] = s.options.apex_m;
  out["clutch_mass_kg"] = s.options.clutch_mass_kg;
  out["torque_constant_nmpa"] = s.options.motor.torque_constant_nmpa;
  out["resistance_ohm"] = s.options.motor.resistance_ohm;
  out["points"] = Json::array();
  for (const Point& p : s.points)
    out["points"].push_back({{"contraction_m", p.contraction_m},
                             {"caught", robot(p.caught)},
                             {"clutched", robot(p.clutched)},
                             {"springless", robot(p.springless)}});
  out["break_even"] = {{"mechanical_m", number(s.mechanical_m)}, {"electrical_m", number(s.electrical_m)}};
  out["springless_below_caught"] = {{"mechanical_m", number(s.springless_mechanical_m)},
                                    {"electrical_m", number(s.springless_electrical_m)}};
  out["as_published"] = {{"coil_j", s.published.coil_j},
                         {"mass_j", s.published.mass_j},
                         {"break_even_m", s.published.break_even_m},
                         {"break_even_with_mass_m", s.published.break_even_with_mass_m}};
  out["variants"] = Json::array();
  for (const Variant& v : s.variants)
    out["variants"].push_back({{"what", v.what},
                               {"mechanical_m", number(v.mechanical_m)},
                               {"electrical_m", number(v.electrical_m)}});
  return out.dump(2) + "\n";
}

}  // namespace furcula::energy
