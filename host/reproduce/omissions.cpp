#include "host/reproduce/omissions.hpp"

namespace furcula::reproduce {

const char* name(Because because) {
  switch (because) {
    case Because::put_in:
      return "put in";
    case Because::otherwise:
      return "done otherwise";
    case Because::recording:
      return "their recording";
    case Because::equipment:
      return "equipment";
    case Because::drawing:
      return "drawing";
    case Because::other_work:
      return "other work";
    case Because::not_computed:
      break;
  }
  return "not computed";
}

std::vector<Omission> omissions_of_002() {
  using enum Because;
  return {
      {"2", "up to 66 % less peak torque, 80 % less energy", other_work, "Of another clutched actuator."},
      {"3.1", "leg angle from 20 to 60 deg", put_in, "Touch-down angle, and the range of section 5.2."},
      {"Fig. 3.1", "description of the mechanism, 5 links", drawing,
       "The equations have its four links and guide."},
      {"Fig. 3.2", "mapping of the parallel spring", drawing,
       "The cam is taken to map as it should: a linear spring along the leg."},
      {"Fig. 3.3", "the linear model", drawing, "Its equations are computed."},
      {"3.2.1", "1 kHz, zero-order hold", put_in, "Step of the examples."},
      {"3.2.1", "z(0) = 0.35 m, z'(0) = 0 m/s", put_in, "Start of the examples."},
      {"3.2.1", "L = 0.15 m, k = 600 N/m, m = 1.5 kg, ds = 5, df = 1 N s/m, both alphas 1", put_in,
       "Model of the examples."},
      {"3.2.1", "T = 2 N m, P = 0.3 s", put_in, "Drive of the examples."},
      {"3.2.1", "alphas of 0.8 and 0.9", put_in, "Losses of Fig. 3.5."},
      {"Fig. 3.6", "the non-linear model", drawing, "Its equations are computed."},
      {"3.2.2", "lower links of 50 g, upper ones of 500 g and 300 g, 0.15 m long", put_in,
       "From these table 3.1's a, b and e are computed."},
      {"3.2.2", "10^-4 and 9 10^-4 kg m^2", put_in, "From these table 3.1's a is computed."},
      {"Table 3.1", "m = 1.6 kg, k = 600 N/m, ds = 5, df = 1 N s/m", put_in, "Both models of Fig. 3.7."},
      {"Table 3.1", "e = 38 10^-3 kg m", put_in, "It gives the upper links' centres, and with them a."},
      {"Table 3.1", "lift-off 1 of the linear model", put_in, "Linear model of Fig. 3.7."},
      {"4", "U10, 80 kV, 1200 W", equipment, "The drive here gives the torque that it is asked for."},
      {"4", "encoder of 2000 counts/rev, 0.09 mm", put_in, "Encoder of the rig."},
      {"4", "1 kHz", put_in, "Rows of the recordings."},
      {"Fig. 4.1", "the setup", drawing, "A photograph."},
      {"Fig. 4.2", "the system's connections", drawing, "A diagram."},
      {"4.1", "Algorithm 1", put_in, "The controller's rule, which all runs here use."},
      {"4.1", "a switch within 10 ms of the contact", put_in, "Switch of the rig."},
      {"Fig. 4.3", "trajectories of the two drives", recording,
       "The torques are not printed. That the hops are stable has rows."},
      {"Fig. 4.4", "touch-down about 5 ms after the switch", recording, "One touch-down of one recording."},
      {"4.2", "15 Hz, third-order Butterworth filter", otherwise,
       "Velocities are slopes of a parabola here; judged by such a filter, errors stand beside those that are smaller."},
      {"Fig. 4.5", "one stride", recording, "Ours are on the page in place of it."},
      {"Fig. 4.6", "its filtered velocity", recording, "Of the same stride."},
      {"4.2", "1.62 kg", put_in, "The rig's mass is drawn within 2 % of it."},
      {"4.2", "force plate he6x6", equipment, "Its errors are drawn."},
      {"4.2, Fig. 4.7", "605 N/m and the line's points", recording,
       "Measured at standstill on the document's spring. The rig's spring is drawn within 2 % of it."},
      {"Fig. 4.8", "what the force plate feels", drawing, "A drawing."},
      {"4.2.1.1", "k = 605 N/m, g = 9.81 m/s^2, z0 = 0.289 m", put_in,
       "Known to the fits there; here as measured of the rig, which is drawn around them."},
      {"4.2.1.1", "m = 1.62 kg in flight", put_in, "As weighed, here as there."},
      {"4.2.1.1", "60 experiments, 10 folds; 20 experiments, 5 folds", put_in, "The same numbers here."},
      {"4.2.1.2", "60 trajectories, 10 folds", put_in, "The same numbers here."},
      {"Fig. 4.12", "the two trajectories", recording, "Of the document's machine. Their errors have rows."},
      {"Fig. 4.15", "the two trajectories", recording, "Of the document's machine. Their errors have rows."},
      {"Fig. 5.1", "working principle of the clutch", drawing, "A drawing."},
      {"Fig. 5.2", "concept of the clutch", drawing, "A drawing."},
      {"5.1", "M3 belt, teeth of about 1.8 mm", put_in, "Belt of the bench."},
      {"5.1", "almost 20 N from a stroke of 2.5 mm", put_in, "Coil of the bench."},
      {"5.1", "solenoid's response within 0 to 20 ms under no load", equipment,
       "A data sheet's. The bench's follows from its coil, under load."},
      {"5.1", "3 cantilever beams, 0.5 to 3 mm thick", not_computed,
       "The return spring is a force and a stiffness here, not a shape."},
      {"Fig. 5.3", "the preliminary setup", drawing, "A drawing."},
      {"Fig. 5.4", "the orthoplanar spring", drawing, "Photographs."},
      {"Fig. 5.5", "the release/catch setup", drawing, "A photograph."},
      {"5.1", "encoder of 2400 counts/rev", put_in, "Encoder of the bench."},
      {"5.1", "sampled at 250 Hz", otherwise, "At 1 kHz here."},
      {"5.1", "40 ms between release and catch, 1 kg", put_in, "The standard trial."},
      {"Fig. 5.7", "the original clamp", drawing, "A photograph."},
      {"Fig. 5.8", "the modular design", drawing, "A drawing."},
      {"Fig. 5.9", "the clutch on the leg", drawing, "Photographs."},
      {"5.2", "stroke of 5 mm, holding up to 15 kg", put_in, "Coil of the modular clutch."},
      {"5.2", "return spring near the solenoid's largest force at about 2 mm", otherwise,
       "The key here uses the last 2.3 mm, against a spring that was chosen."},
      {"5.2", "3M belt", put_in, "Belt of the modular clutch."},
      {"5.2", "apex of 0.34 m, actuation period of 0.3 s", put_in, "The case that is computed."},
      {"5.2", "contraction A sin(2 pi t / P) with P = 0.4 s", put_in,
       "Of the simulated legs. The document's integral over it is k A^2 / 2 for any P."},
      {"5.2", "7 cm of the auxiliary spring for 10 cm of leg", put_in, "Gear of cable and leg."},
      {"5.2", "solenoid of 700 g", equipment, "Of the clutch's 1 kg, which is put in as a whole."},
      {"Fig. 5.10b", "energy over the clutch's mass", not_computed, "At 1 kg alone."},
      {"Fig. 5.6", "counts of the document's trial", recording, "The bench's are drawn in place of them."},
  };
}

}  // namespace furcula::reproduce
