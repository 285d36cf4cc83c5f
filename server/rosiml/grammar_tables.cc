// SPDX-License-Identifier: MIT
#include "server/rosiml/grammar_tables.h"

namespace coopdyn::rosiml {

namespace {

constexpr Rule kPublic[] = {
    {"&objects", "", "box sphere cylinder capsule ply composite macro"},
    {"&parts", "", "pose? -visualisation physics!"},
    {"&sensed", "", "object=reference! mapping=ends? noise? filter?"},
    {"&driven", "",
     "source=reference! destination=reference? force=most_force! velocity=most_velocity! pose! deflection? "
     "mapping=ends? "
     "-regular -limit "
     "-orthogonal ~pid noise? ~filter"},
    {"&axis", "",
     "force=most_force! velocity=most_velocity! deflection? mapping=ends? -limit spring? ~pid noise? "
     "~filter"},
    {"rosiml", "version!:s",
     "-comment simulator! ~screens? macros? environment? robots? ~traces? ~logging? ~signals?"},
    {"simulator", "frequency!:n10..2000", "-solver? control?"},
    {"control", "iterations:i ~reset:i seed:i", ""},
    {"macros", "", "macro=macro_definition"},
    {"macro_definition", "name!:s", "&objects"},
    {"macro", "name!:s ref!:s", "pose? -target"},
    {"environment", "-name:s", "gravitation? ground? &objects pointLightSource ambientLight?"},
    {"gravitation", "x:n y:n z:n", ""},
    {"ground", "-fixed:b -fog:b -fogIntensity:n", "-visualisation"},
    {"pointLightSource", "name:s x!:n y!:n z!:n colour!:c brightness!:n0..1000000 -draw:b -size:n", ""},
    {"ambientLight", "-colour:c brightness!:n0..1000000", ""},
    {"box", "name!:s -visualise:b", "dimension=box_dimension! &parts"},
    {"sphere", "name!:s -visualise:b", "dimension=sphere_dimension! &parts"},
    {"cylinder", "name!:s -visualise:b", "dimension=round_dimension! &parts"},
    {"capsule", "name!:s -visualise:b", "dimension=round_dimension! &parts"},
    {"ply", "name!:s filename!:s -convex:b -soft:b -visualise:b", "-dimension &parts"},
    {"composite", "name!:s -visualise:b", "geometry! &parts"},
    {"geometry", "", "box=box sphere=sphere cylinder=cylinder capsule=capsule ply=ply"},
    {"box_dimension", "width!:+..1000 depth!:+..1000 height!:+..1000", ""},
    {"sphere_dimension", "radius!:+..1000", ""},
    {"round_dimension", "radius!:+..1000 height!:+..1000", ""},
    {"pose", "x:n y:n z:n alpha:n beta:n gamma:n type:deg|rad global:b", ""},
    {"physics", "",
     "mass? centreOfMass? friction=factor? ~rollingFriction? ~linearDamping? ~angularDamping? "
     "restitution=factor?"},
    {"mass", "kg!:n0..1000000", ""},
    {"centreOfMass", "x:n y:n z:n", ""},
    {"factor", "value!:0", ""},
    {"robots", "", "robot"},
    {"robot", "name!:s", "body! pose? actuators? sensors? controller?"},
    {"controller", "module!:s frequency:+", "parameter"},
    {"parameter", "name!:s value!:s", ""},
    {"ends", "min!:n max!:n", ""},
    {"coordinates", "x!:b y!:b z!:b", ""},
    {"noise", "module!:gauss|white", "parameter"},
    {"filter", "module!:s", "parameter"},
    {"body", "~selfCollide:b", "&objects"},
    {"actuators", "", "hinge slider fixed generic muscle"},
    {"hinge",
     "name!:s type!:velocity|angular|force|force_and_velocity|force_and_angle mode!:active|passive "
     "friction:0",
     "&driven"},
    {"muscle", "name!:s -visualise:b -friction:n -erp:n -cfm:n",
     "source=reference! destination=reference! srcAnchor=anchor! dstAnchor=anchor! force=most_force! "
     "-velocity "
     "-deflection mapping=ends? lengthComponent! velocityComponent! -regular -limit -orthogonal "
     "-visualisation "
     "noise? ~filter"},
    {"anchor", "coordinateSystem:local|global", "&objects"},
    {"lengthComponent", "optimalLength!:+ w!:+ c!:n0..1000000 use!:b", ""},
    {"velocityComponent", "maxVelocity!:n N!:n1..1000000 K!:+ use!:b", ""},
    {"slider", "name!:s type!:positional|velocity|force|force_and_velocity mode!:active|passive friction:0",
     "&driven"},
    {"fixed", "name!:s", "source=reference! destination=reference? -pose"},
    {"generic", "name!:s spring:b",
     "source=reference! destination=reference? pose! rotational? translational?"},
    {"rotational", "", "x=turning? y=turning? z=turning?"},
    {"translational", "", "-limit x=sliding? y=sliding? z=sliding?"},
    {"turning",
     "type!:velocity|angular|force|force_and_velocity|force_and_angle mode!:active|passive friction:0",
     "&axis"},
    {"sliding", "type!:positional|velocity|force|force_and_velocity mode!:active|passive friction:0",
     "&axis"},
    {"spring", "stiffness!:0 damping!:0", ""},
    {"reference", "name!:s", ""},
    {"most_force", "max!:n0..1000000 ~scaling:n", ""},
    {"most_velocity", "max!:n0..10000 ~scaling:n", ""},
    {"deflection", "min!:n max!:n", ""},
    {"sensors", "",
     "proximity position=coordinate_sensor orientation=coordinate_sensor ov=coordinate_sensor "
     "oav=coordinate_sensor "
     "velocity=joint_sensor deflection=joint_sensor ldr binaryContact camera=camera_sensor "
     "ambientLight=ambient_sensor sharpDM2Y3A003K0F=sharp sharpGP2D12_37=sharp ~generic muscle=muscle_sensor "
     "~internalEnergy ~feedback ~signal"},
    {"proximity", "name!:s", "pose! distance! openingAngles! &sensed"},
    {"distance", "meter!:n0.001..100000", ""},
    {"openingAngles", "x!:n0..180 y!:n0..180", ""},
    {"coordinate_sensor", "name!:s global:b", "coordinates? domain=ends? &sensed"},
    {"joint_sensor", "name!:s", "domain=ends? &sensed"},
    {"muscle_sensor", "name!:s", "-pose object=reference! domain=ends mapping=ends noise? filter?"},
    {"ldr", "name!:s opening!:n0..180", "pose! colour=seen_colour? &sensed"},
    {"seen_colour", "value!:c", ""},
    {"camera_sensor", "name!:s", "pose! openingAngles! &sensed"},
    {"ambient_sensor", "name!:s", "mapping=ends? domain=ends? noise? filter?"},
    {"sharp", "name!:s", "pose! &sensed"},
    {"binaryContact", "name!:s", "domain=ends? &sensed"},
};

constexpr Rule kPaper[] = {
    {"&weight", "mass:n0..1000000 friction:0 bounce:0 colour:c", ""},
    {"&exchanged", "auxiliary:b", "mapping=ends? noise=value_noise? filter=value_filter?"},
    {"ends", "min!:n max!:n", ""},
    {"value_noise", "kind!:uniform|gauss sigma!:0 mean:n", ""},
    {"value_filter", "kind!:mean|median|lowPass steps:i time:+", ""},
    {"&shapes", "", "box=shape_box sphere=shape_sphere cylinder=shape_round capsule=shape_round"},
    {"rosiml", "version:s", "-comment simulator? environment? movables! score"},
    {"score",
     "name:s kind!:reach|time|distance|travelled|collisions|nearest|energy|upright|formation|coverage of:s "
     "target:s within:n0.0001..100000 tilt:n0..180 cell:n0.01..100 until:s limit:+",
     ""},
    {"simulator",
     "frequency:n10..2000 controllerFrequency:+ seed:i0..1e9 duration:+ mode:realtime|lockstep|free speed:n "
     "gravity:n-1000..1000",
     "~window? ~camera? ~keys?"},
    {"environment", "",
     "ground? ambient? light box=thing_box sphere=thing_sphere cylinder=thing_round "
     "capsule=thing_round object=thing"},
    {"ground", "width:+ depth:+ friction:n0..1000 colour:c", ""},
    {"ambient", "value!:n0..1000000", "randomise=random_value?"},
    {"light", "name:s x!:n y!:n z!:n power:n0..1000000 colour:c shadows:b", "randomise=random_place?"},
    {"thing_box", "name!:s width!:+..1000 depth!:+..1000 height!:+..1000 &weight", "pose? randomise?"},
    {"thing_sphere", "name!:s radius!:+..1000 &weight", "pose? randomise?"},
    {"thing_round", "name!:s radius!:+..1000 height!:+..1000 &weight", "pose? randomise?"},
    {"thing", "name!:s &weight", "pose? randomise? &shapes"},
    {"pose", "x:n y:n z:n alpha:n beta:n gamma:n type:deg|rad", ""},
    {"randomise", "x:r y:r z:r gamma:r mass:r friction:r", ""},
    {"random_value", "value!:r", ""},
    {"random_place", "x:r y:r z:r power:r", ""},
    {"shape_box", "width!:+..1000 depth!:+..1000 height!:+..1000 colour:c", "pose?"},
    {"shape_sphere", "radius!:+..1000 colour:c", "pose?"},
    {"shape_round", "radius!:+..1000 height!:+..1000 colour:c", "pose?"},
    {"movables", "", "movable"},
    {"movable", "name!:s type!:active|passive|controlled|moving colour:c",
     "pose? randomise=random_start? controller? force=thrust? torque=thrust? body!"},
    {"thrust", "max!:+..1000000", "mapping=ends? noise=value_noise?"},
    {"random_start", "x:r y:r gamma:r", ""},
    {"controller", "library!:s", "parameter"},
    {"parameter", "name!:s value!:n", ""},
    {"body", "", "compound object connector"},
    {"compound", "name!:s", "pose? compound object connector"},
    {"object", "name!:s mass!:n0..1000000 friction:0 bounce:0 colour:c",
     "pose? &shapes proximity ldr compass contact imu sharp camera=camera_sensor neighbours ~energy "
     "ambientLight position=of_place orientation=of_place velocity=of_place angularVelocity=of_place"},
    {"of_place", "name!:s x:b y:b z:b frame:world|body &exchanged", "domain=ends? &exchanged"},
    {"proximity",
     "name!:s range!:n0.001..100000 opening:n0..360 openingUp:n0..360 pattern:cross|fan|cone rays:i1..1000 "
     "noise:0 &exchanged",
     "pose? &exchanged"},
    {"ldr", "name!:s opening:n0..360 colour:c &exchanged", "pose? domain=ends? &exchanged"},
    {"ambientLight", "name!:s &exchanged", "domain=ends? &exchanged"},
    {"compass", "name!:s noise:n0..180 &exchanged", "&exchanged"},
    {"contact", "name!:s abort:b &exchanged", "&exchanged"},
    {"imu", "name!:s", "pose?"},
    {"sharp", "name!:s model!:gp2d12|dm2y3a003k0f &exchanged", "pose? domain=ends? &exchanged"},
    {"camera_sensor", "name!:s width:i1..4096 height:i1..4096 opening:n1..175", "pose?"},
    {"neighbours", "name!:s range!:n0.001..100000", ""},
    {"connector",
     "name!:s type!:hinge|slider|ball|fixed|universal|hinge2|sixAxis|complexHinge source!:s destination:s",
     "pose? axis limit? drive? spring? damper=joint_factor? friction=joint_friction? read backlash? rotor? "
     "coupling? pwm ~noise"},
    {"axis", "name!:x|y|z|rx|ry|rz",
     "limit? drive? spring? damper=joint_factor? friction=joint_factor? read"},
    {"limit", "min!:n max!:n", ""},
    {"drive", "type:velocity|position|force maxForce!:+..1000000 maxVelocity!:+..10000",
     "mapping=ends? noise=value_noise?"},
    {"spring", "stiffness!:0 rest:n", ""},
    {"joint_factor", "value!:0", ""},
    {"joint_friction", "value!:0 static:0 threshold:0", ""},
    {"backlash", "gap!:n0..360", ""},
    {"rotor", "inertia:+ ratio:n0.001..100000 efficiency:n0.01..1", ""},
    {"coupling", "stiffness!:+ damping:0 preload:0", ""},
    {"pwm", "duty!:+..1 noLoadSpeed!:+ stallTorque!:n0..1000000 stallCurrent:n0..1000000", ""},
    {"read", "what!:position|velocity|force|current|energy &exchanged", "domain=ends? &exchanged"},
};

constexpr std::string_view kOther = "is not used here";

constexpr NotYet kNotYet[] = {
    {"screens", "coopdyn's page and its cameras show the simulation", kOther},
    {"window", "coopdyn's page shows the simulation", kOther},
    {"keys", "coopdyn's page has its own", kOther},
    {"traces", "the page draws trails", kOther},
    {"logging", "record the run, and export it: coopdyn serve --record, coopdyn export", kOther},
    {"signals", "they are left out"},
    {"reset", "reset the run with coopdyn reset, or a new seed"},
    {"rollingFriction", "only sliding friction is used"},
    {"linearDamping", "bodies move without it"},
    {"angularDamping", "bodies turn without it"},
    {"selfCollide", "parts of one robot do not touch each other"},
    {"generic", "sensors of joints of six axes are left out: motors tell positions and velocities"},
    {"noise", "values have none"},
    {"filter", "motor values are not filtered"},
    {"pid", "the motor reaches its velocity within its force"},
    {"scaling", "the force is the same everywhere"},
};

}  // namespace

std::span<const Rule> RulesOf(Dialect dialect) {
  if (dialect == Dialect::kPaper) return kPaper;
  return kPublic;
}

std::span<const NotYet> NotSimulatedYet() {
  return kNotYet;
}

}  // namespace coopdyn::rosiml
