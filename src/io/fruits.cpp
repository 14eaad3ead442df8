// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/results.hpp>

#include <set>

#include "csv.hpp"
#include "json_value.hpp"
#include "result_texts.hpp"

namespace agrisee::io {
namespace {

Eigen::Vector4d xyzw(const Eigen::Matrix3d& rotation) { return quaternion(rotation).coeffs(); }

Json finite(double value, const char* what) {
  check_input(std::isfinite(value), what);
  return value + 0.0;
}

Json to_json(const Fruit& fruit) {
  Json j;
  j["id"] = fruit.id;
  j["points"] = fruit.points;
  j["found_by"] = fruit.found_by;
  j["centroid_cluster"] = json_list(fruit.centroid_cluster, "fruit: centroid_cluster is not finite");
  j["centroid_world"] = json_list(fruit.centroid, "fruit: centroid_world is not finite");
  j["sigma_world"] = json_list(fruit.sigma, "fruit: sigma_world is not finite");
  j["orientation_world"] = json_list(xyzw(fruit.orientation), "fruit: orientation_world is not finite");
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
  }
  return j;
}

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
  return body;
}

}  // namespace

std::string fruits_text(const std::vector<Fruit>& fruits) {
  Json list = Json::array();
  for (const Fruit& fruit : fruits) list.push_back(to_json(fruit));
  return dump(list);
}

std::string fruits_csv_text(const std::vector<Fruit>& fruits) {
  CsvWriter csv;
  for (const char* name : {"id", "points", "found_by"}) csv.cell(name);
  for (const char* name : {"centroid_cluster", "centroid_world", "sigma_world", "orientation_world", "center_world",
                           "radii", "body_orientation_world"}) {
    const bool quaternion = std::string_view(name).find("orientation") != std::string_view::npos;
    const bool radii = std::string_view(name) == "radii";
    const char* const suffixes[] = {radii ? "a" : "x", radii ? "b" : "y", radii ? "c" : "z", "w"};
    for (int i = 0; i < (quaternion ? 4 : 3); ++i) csv.cell(std::string(name) + "_" + suffixes[i]);
  }
  for (const char* name : {"completeness", "confidence"}) csv.cell(name);
  csv.end_row();
  for (const Fruit& fruit : fruits) {
    csv.cell(std::to_string(fruit.id));
    csv.cell(fruit.points);
    csv.cell(fruit.found_by);
    csv.cells(fruit.centroid_cluster);
    csv.cells(fruit.centroid);
    csv.cells(fruit.sigma);
    csv.cells(xyzw(fruit.orientation));
    if (fruit.body) {
      csv.cells(fruit.body->center);
      csv.cells(fruit.body->radii);
      csv.cells(xyzw(fruit.body->axes));
      csv.cell(fruit.body->completeness);
      csv.cell(fruit.body->confidence);
    } else {
      csv.empty_cells(12);
    }
    csv.end_row();
  }
  return csv.text();
}

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
    const std::uint64_t id = value.at("id").count();
    if (id < 1 || id > 1000000) value.at("id").fail("has to be positive");
    fruit.id = static_cast<int>(id);
    if (!ids.insert(fruit.id).second) value.at("id").fail("two fruits have the id " + std::to_string(id));
    fruit.points = static_cast<std::size_t>(value.at("points").count());
    fruit.found_by = value.at("found_by").text();
    fruit.centroid_cluster = value.at("centroid_cluster").numbers<3>();
    fruit.centroid = value.at("centroid_world").numbers<3>();
    fruit.sigma = value.at("sigma_world").numbers<3>();
    fruit.orientation = rotation(value.at("orientation_world"));
    if (value.has("center_world") && value.has("radii")) fruit.body = body_of(value);
    fruits.push_back(fruit);
  }
  return fruits;
}

}  // namespace agrisee::io
