// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/results.hpp>

#include <algorithm>
#include <set>

#include "io/formats/csv.hpp"
#include "io/formats/json_value.hpp"
#include "io/results/result_texts.hpp"

namespace agrisee::io {
namespace {

/// The quaternion of a rotation, in the order x y z w.
Eigen::Vector4d xyzw(const Eigen::Matrix3d& rotation) { return quaternion(rotation).coeffs(); }

/// A number; minus zero becomes zero. @throws InputError with the message `what` if it is not finite
Json finite(double value, const char* what) {
  check_input(std::isfinite(value), what);
  return value + 0.0;
}

/// The upper triangle of a covariance: xx, xy, xz, yy, yz, zz.
Eigen::Matrix<double, 6, 1> triangle(const Eigen::Matrix3d& m) {
  return (Eigen::Matrix<double, 6, 1>() << m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)).finished();
}

/// Add the picking plan of a fruit to its JSON object.
void add_picking(Json& j, const Picking& picking) {
  j["picking_order"] = picking.order;
  j["picking_after"] = picking.after;
  j["reachable"] = picking.reachable;
  j["picking_reason"] = to_string(picking.reason);
  check_input(picking.direction.allFinite(), "fruit: approach_direction_world is not finite");
  if (picking.direction.isZero(0.0)) return;  // there is no approach
  j["approach_direction_world"] = json_list(picking.direction, "");
  const Pose& pose = picking.world_T_pre_grasp;
  j["pre_grasp_position_world"] = json_list(pose.translation(), "fruit: pre_grasp_position_world is not finite");
  j["pre_grasp_orientation_world"] = json_list(xyzw(pose.linear()), "fruit: pre_grasp_orientation_world is not finite");
  if (picking.joints) j["pre_grasp_joints"] = json_list(*picking.joints, "fruit: pre_grasp_joints is not finite");
  j["approach_crossed"] = finite(picking.crossed, "fruit: approach_crossed is not finite");
}

/// Add the nine cells of its ripeness to the row of a fruit.
void add_ripeness(CsvWriter& csv, const std::optional<Ripeness>& ripeness) {
  if (!ripeness) return csv.empty_cells(9);
  csv.cell(to_string(ripeness->grade));
  for (const double value : {ripeness->probability, ripeness->ripe_share, ripeness->ripe_share_error}) csv.cell(value);
  csv.cells(ripeness->lab);
  csv.cell(ripeness->hue);
  csv.cell(ripeness->hue_error);
}

/// Whether any fruit has a ripeness: else the table has no columns for it.
bool any_ripeness(const std::vector<Fruit>& fruits) {
  return std::any_of(fruits.begin(), fruits.end(), [](const Fruit& f) { return f.ripeness.has_value(); });
}

/// Add the 20 cells of a picking plan to the row of its fruit.
void add_picking(CsvWriter& csv, const Picking& picking) {
  csv.cell(static_cast<std::size_t>(picking.order));
  std::string after;
  for (int id : picking.after) after += (after.empty() ? "" : " ") + std::to_string(id);
  csv.cell(after);
  csv.cell(picking.reachable ? "true" : "false");
  csv.cell(to_string(picking.reason));
  if (picking.direction.isZero(0.0)) return csv.empty_cells(16);
  csv.cells(picking.direction);
  csv.cells(picking.world_T_pre_grasp.translation());
  csv.cells(xyzw(picking.world_T_pre_grasp.linear()));
  if (picking.joints)
    csv.cells(*picking.joints);
  else
    csv.empty_cells(6);
}

/// @param ripeness whether there are columns for it
void add_head(CsvWriter& csv, bool ripeness) {
  for (const char* name : {"id", "points", "found_by"}) csv.cell(name);
  for (const char* name : {"centroid_cluster", "centroid_world", "sigma_world", "orientation_world", "center_world",
                           "radii", "body_orientation_world"}) {
    const bool quaternion = std::string_view(name).find("orientation") != std::string_view::npos;
    const bool radii = std::string_view(name) == "radii";
    const char* const suffixes[] = {radii ? "a" : "x", radii ? "b" : "y", radii ? "c" : "z", "w"};
    for (int i = 0; i < (quaternion ? 4 : 3); ++i) csv.cell(std::string(name) + "_" + suffixes[i]);
  }
  for (const char* name : {"completeness", "confidence", "rms", "volume", "volume_error", "mass", "mass_error"})
    csv.cell(name);
  for (const char* name : {"xx", "xy", "xz", "yy", "yz", "zz"})
    csv.cell("center_covariance_world_" + std::string(name));
  for (const char* name : {"picking_order", "picking_after", "reachable", "picking_reason"}) csv.cell(name);
  for (const char* name : {"approach_direction_world", "pre_grasp_position_world"})
    for (const char* axis : {"_x", "_y", "_z"}) csv.cell(std::string(name) + axis);
  for (const char* axis : {"_x", "_y", "_z", "_w"}) csv.cell("pre_grasp_orientation_world" + std::string(axis));
  for (int i = 1; i <= 6; ++i) csv.cell("pre_grasp_q" + std::to_string(i));
  for (const char* name : {"position_world", "position_cluster"})
    for (const char* axis : {"_x", "_y", "_z"}) csv.cell(std::string(name) + axis);
  csv.cell("truss");
  csv.cell("growth_axis_error");
  csv.cell("approach_crossed");
  if (ripeness)
    for (const char* name : {"ripeness_class", "ripeness_probability", "ripe_share", "ripe_share_error", "lab_l",
                             "lab_a", "lab_b", "hue", "hue_error"})
      csv.cell(name);
  csv.end_row();
}

/// Add the 23 cells of a body to the row of its fruit.
void add_body(CsvWriter& csv, const Body& body) {
  csv.cells(body.center);
  csv.cells(body.radii);
  csv.cells(xyzw(body.axes));
  csv.cell(body.completeness);
  csv.cell(body.confidence);
  for (double value : {body.rms, body.volume, body.volume_error, body.mass, body.mass_error}) csv.cell(value);
  csv.cells(triangle(body.center_covariance));
}

Json to_json(const Fruit& fruit) {
  Json j;
  j["id"] = fruit.id;
  j["truss"] = fruit.truss;
  j["points"] = fruit.points;
  j["found_by"] = fruit.found_by;
  j["position_world"] = json_list(fruit.position(), "fruit: position_world is not finite");
  j["position_cluster"] = json_list(fruit.position_cluster(), "fruit: position_cluster is not finite");
  j["centroid_cluster"] = json_list(fruit.centroid_cluster, "fruit: centroid_cluster is not finite");
  j["centroid_world"] = json_list(fruit.centroid, "fruit: centroid_world is not finite");
  j["sigma_world"] = json_list(fruit.sigma, "fruit: sigma_world is not finite");
  j["orientation_world"] = json_list(xyzw(fruit.orientation), "fruit: orientation_world is not finite");
  if (fruit.growth_axis_error)
    j["growth_axis_error"] = finite(*fruit.growth_axis_error, "fruit: growth_axis_error is not finite");
  if (fruit.body) {
    const Body& body = *fruit.body;
    j["center_world"] = json_list(body.center, "fruit: center_world is not finite");
    j["radii"] = json_list(body.radii, "fruit: radii is not finite");
    j["body_orientation_world"] = json_list(xyzw(body.axes), "fruit: body_orientation_world is not finite");
    Json covariance = Json::array();
    for (int r = 0; r < 3; ++r)
      covariance.push_back(json_list(body.center_covariance.row(r), "fruit: center_covariance_world is not finite"));
    j["center_covariance_world"] = covariance;
    j["rms"] = finite(body.rms, "fruit: rms is not finite");
    j["completeness"] = finite(body.completeness, "fruit: completeness is not finite");
    j["confidence"] = finite(body.confidence, "fruit: confidence is not finite");
    j["volume"] = finite(body.volume, "fruit: volume is not finite");
    j["volume_error"] = finite(body.volume_error, "fruit: volume_error is not finite");
    j["mass"] = finite(body.mass, "fruit: mass is not finite");
    j["mass_error"] = finite(body.mass_error, "fruit: mass_error is not finite");
  }
  if (fruit.picking) add_picking(j, *fruit.picking);
  if (fruit.ripeness) j["ripeness"] = ripeness_json(*fruit.ripeness);
  return j;
}

/// The rotation of a quaternion x y z w.
Eigen::Matrix3d rotation(const JsonValue& value) {
  const Eigen::Vector4d q = value.numbers<4>();
  if (!(std::abs(q.norm() - 1.0) < 1e-3)) value.fail("the quaternion is not of unit length");
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
}

Body body_of(const JsonValue& value) {
  Body body;
  body.center = value.at("center_world").numbers<3>();
  body.radii = value.at("radii").numbers<3>();
  if (value.has("body_orientation_world")) body.axes = rotation(value.at("body_orientation_world"));
  if (value.has("center_covariance_world")) {
    const JsonValue rows = value.at("center_covariance_world");
    if (rows.list_size() != 3) rows.fail("expected three rows");
    for (int r = 0; r < 3; ++r)
      body.center_covariance.row(r) = rows.at(static_cast<std::size_t>(r)).numbers<3>().transpose();
  }
  if (value.has("rms")) body.rms = value.at("rms").number();
  if (value.has("completeness")) body.completeness = value.at("completeness").number();
  if (value.has("confidence")) body.confidence = value.at("confidence").number();
  if (value.has("volume")) body.volume = value.at("volume").number();
  if (value.has("volume_error")) body.volume_error = value.at("volume_error").number();
  if (value.has("mass")) body.mass = value.at("mass").number();
  if (value.has("mass_error")) body.mass_error = value.at("mass_error").number();
  return body;
}

/// An id or a place in the picking order: 1 to 1,000,000.
int positive_integer(const JsonValue& value) {
  const std::uint64_t n = value.count();
  if (n < 1 || n > 1000000) value.fail("must be from 1 to 1000000");
  return static_cast<int>(n);
}

PickingReason reason_of(const JsonValue& value) {
  const std::string text = value.text();
  for (int i = 0; i <= static_cast<int>(PickingReason::arm_meets_fruit); ++i)
    if (text == to_string(static_cast<PickingReason>(i))) return static_cast<PickingReason>(i);
  value.fail("unknown picking reason '" + text + "'");
}

Picking picking_of(const JsonValue& value) {
  Picking picking;
  picking.order = positive_integer(value.at("picking_order"));
  picking.reachable = value.at("reachable").boolean();
  picking.reason = reason_of(value.at("picking_reason"));
  if (value.has("picking_after")) {
    const JsonValue ids = value.at("picking_after");
    for (std::size_t i = 0; i < ids.list_size(); ++i) picking.after.push_back(positive_integer(ids.at(i)));
  }
  if (!value.has("approach_direction_world")) return picking;
  picking.direction = value.at("approach_direction_world").numbers<3>();
  picking.world_T_pre_grasp.translation() = value.at("pre_grasp_position_world").numbers<3>();
  picking.world_T_pre_grasp.linear() = rotation(value.at("pre_grasp_orientation_world"));
  if (value.has("pre_grasp_joints")) picking.joints = value.at("pre_grasp_joints").numbers<6>();
  if (value.has("approach_crossed")) picking.crossed = value.at("approach_crossed").number();
  return picking;
}

/// @throws FileError for a class that is not known
Ripeness ripeness_of(const JsonValue& value) {
  Ripeness out;
  const std::string grade = value.at("class").text();
  const auto named = ripeness_named(grade);
  if (!named) value.at("class").fail("unknown class of ripeness '" + grade + "'");
  out.grade = *named;
  out.probability = value.at("probability").number();
  out.ripe_share = value.at("ripe_share").number();
  out.ripe_share_error = value.at("ripe_share_error").number();
  out.lab = value.at("lab").numbers<3>();
  out.hue = value.at("hue").number();
  out.hue_error = value.at("hue_error").number();
  out.points = static_cast<std::size_t>(value.at("points").count());
  return out;
}

/// @throws InputError for two fruits with the same id, which read_fruits refuses
void check_ids(const std::vector<Fruit>& fruits) {
  std::set<int> ids;
  for (const Fruit& fruit : fruits)
    if (!ids.insert(fruit.id).second) throw InputError("fruits: two have the id " + std::to_string(fruit.id));
}

}  // namespace

Json ripeness_json(const Ripeness& ripeness) {
  Json r;
  r["class"] = to_string(ripeness.grade);
  r["probability"] = finite(ripeness.probability, "ripeness: probability is not finite");
  r["ripe_share"] = finite(ripeness.ripe_share, "ripeness: ripe_share is not finite");
  r["ripe_share_error"] = finite(ripeness.ripe_share_error, "ripeness: ripe_share_error is not finite");
  r["lab"] = json_list(ripeness.lab, "ripeness: lab is not finite");
  r["hue"] = finite(ripeness.hue, "ripeness: hue is not finite");
  r["hue_error"] = finite(ripeness.hue_error, "ripeness: hue_error is not finite");
  r["points"] = ripeness.points;
  return r;
}

std::string fruits_text(const std::vector<Fruit>& fruits) {
  check_ids(fruits);
  Json list = Json::array();
  for (const Fruit& fruit : fruits) list.push_back(to_json(fruit));
  return dump(list);
}

std::string fruits_csv_text(const std::vector<Fruit>& fruits) {
  check_ids(fruits);
  CsvWriter csv;
  const bool ripeness = any_ripeness(fruits);
  add_head(csv, ripeness);
  for (const Fruit& fruit : fruits) {
    csv.cell(std::to_string(fruit.id));
    csv.cell(fruit.points);
    csv.cell(fruit.found_by);
    csv.cells(fruit.centroid_cluster);
    csv.cells(fruit.centroid);
    csv.cells(fruit.sigma);
    csv.cells(xyzw(fruit.orientation));
    if (fruit.body)
      add_body(csv, *fruit.body);
    else
      csv.empty_cells(23);
    if (fruit.picking)
      add_picking(csv, *fruit.picking);
    else
      csv.empty_cells(20);
    csv.cells(fruit.position());
    csv.cells(fruit.position_cluster());
    csv.cell(static_cast<std::size_t>(fruit.truss));
    if (fruit.growth_axis_error)
      csv.cell(*fruit.growth_axis_error);
    else
      csv.empty_cells(1);
    if (fruit.picking && !fruit.picking->direction.isZero(0.0))
      csv.cell(fruit.picking->crossed);
    else
      csv.empty_cells(1);
    if (ripeness) add_ripeness(csv, fruit.ripeness);
    csv.end_row();
  }
  return csv.text();
}

std::string fruits_to_json(const std::vector<Fruit>& fruits) { return fruits_text(fruits); }

void write_fruits(const std::filesystem::path& path, const std::vector<Fruit>& fruits) {
  write_file(path, fruits_text(fruits));
}

void write_fruits_csv(const std::filesystem::path& path, const std::vector<Fruit>& fruits) {
  write_file(path, fruits_csv_text(fruits));
}

std::vector<Fruit> read_fruits(const std::filesystem::path& path) {
  const Json json = load_json(path);
  const JsonValue list(path, json, "");
  std::vector<Fruit> fruits;
  std::set<int> ids;
  for (std::size_t i = 0; i < list.list_size(); ++i) {
    const JsonValue value = list.at(i);
    Fruit fruit;
    fruit.id = positive_integer(value.at("id"));
    if (!ids.insert(fruit.id).second) value.at("id").fail("two fruits have the id " + std::to_string(fruit.id));
    if (value.has("truss")) fruit.truss = positive_integer(value.at("truss"));
    fruit.points = static_cast<std::size_t>(value.at("points").count());
    fruit.found_by = value.at("found_by").text();
    fruit.centroid_cluster = value.at("centroid_cluster").numbers<3>();
    fruit.centroid = value.at("centroid_world").numbers<3>();
    fruit.sigma = value.at("sigma_world").numbers<3>();
    fruit.orientation = rotation(value.at("orientation_world"));
    if (value.has("growth_axis_error")) fruit.growth_axis_error = value.at("growth_axis_error").number();
    if (value.has("center_world") && value.has("radii")) fruit.body = body_of(value);
    if (value.has("picking_order")) fruit.picking = picking_of(value);
    if (value.has("ripeness")) fruit.ripeness = ripeness_of(value.at("ripeness"));
    fruits.push_back(fruit);
  }
  return fruits;
}

}  // namespace agrisee::io
