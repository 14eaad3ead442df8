// SPDX-License-Identifier: BSD-3-Clause
#include "season/database.hpp"

#include <agrisee/core/parallel.hpp>
#include <agrisee/io/fingerprint.hpp>

#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "season/schema.hpp"
#include "season/sqlite.hpp"

namespace agrisee::season {
namespace {

namespace fs = std::filesystem;

/// Prepare a database for writing. @throws FileError if it belongs to something else
void prepare(const Connection& connection) {
  const bool is_new = connection.integer("SELECT count(*) FROM sqlite_master") == 0;
  if (!is_new) check_schema(connection);
  connection.run("PRAGMA foreign_keys = ON; BEGIN IMMEDIATE;");
  connection.run(kSchema);
  if (!is_new) return;
  connection.run(("PRAGMA application_id = " + std::to_string(kApplicationId) +
                  "; PRAGMA user_version = " + std::to_string(kSchemaVersion))
                     .c_str());
}

/// A scan as the database knows it.
struct Entry {
  const Scan* scan;
  std::string folder;   ///< relative to the database
  Place place;          ///< by the rules
  std::string content;  ///< fingerprint of what is stored
};

/// A scan that the database has.
struct Known {
  long long id;
  std::string folder;
  bool has_result;
};

/// Ids of texts that are stored once.
class Texts {
 public:
  Texts(const Connection& connection, const char* select, const char* insert)
      : connection_(connection), select_(connection, select), insert_(connection, insert) {}
  /// @param other a second column, if the table has one
  long long id_of(const std::string& text, const std::optional<std::string>& other = {}) {
    if (const auto known = ids_.find(text); known != ids_.end()) return known->second;
    select_.bind(text);
    long long id = 0;
    if (select_.step()) {
      id = select_.integer(0);
      select_.reset();
    } else {
      insert_.bind(text);
      if (other) insert_.bind(*other);
      insert_.run();
      id = connection_.last_id();
    }
    ids_[text] = id;
    return id;
  }

 private:
  const Connection& connection_;
  Statement select_, insert_;
  std::map<std::string, long long> ids_;
};

/// Writes scans.
class Writer {
 public:
  explicit Writer(const Connection& connection)
      : connection_(connection),
        versions_(connection, "SELECT id FROM versions WHERE version = ?", "INSERT INTO versions(version) VALUES (?)"),
        parameters_(connection, "SELECT id FROM parameters WHERE json = ?",
                    "INSERT INTO parameters(json, preset) VALUES (?, ?)"),
        known_(connection, "SELECT id, content FROM scans WHERE folder = ?"),
        same_(connection, "SELECT id, folder, status FROM scans WHERE content = ? AND input = ? ORDER BY id"),
        doubled_(connection, "SELECT content, input FROM scans GROUP BY content, input HAVING count(*) > 1"),
        move_(connection, "UPDATE scans SET folder = ? WHERE id = ?"),
        forget_(connection, "DELETE FROM scans WHERE id = ?"),
        scan_(connection,
              "INSERT INTO scans(folder, content, status, message, input, \"row\", date, time, version, parameters, "
              "scene, planner, noise, seed, fruit, views, stop_reason, points_merged, points_filtered, "
              "points_labelled, seconds) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        fruit_(connection, "INSERT INTO fruit VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        view_(connection, "INSERT INTO views VALUES (?,?,?,?,?,?,?,?,?,?,?)") {}

  /// The content with which a folder is known, and its id; 0 if it is not.
  std::pair<long long, std::string> find(const std::string& folder) {
    std::pair<long long, std::string> out{0, ""};
    known_.bind(folder);
    if (known_.step()) out = {known_.integer(0), known_.text(1)};
    known_.reset();
    return out;
  }
  /// The scans with a content, which failures share, and an input.
  std::vector<Known> same(const std::string& content, const std::string& input) {
    std::vector<Known> out;
    same_.bind(content).bind(input);
    while (same_.step()) out.push_back({same_.integer(0), same_.text(1), same_.text(2) == "ok"});
    return out;
  }
  /// Content and input of scans that are there more than once.
  std::vector<std::pair<std::string, std::string>> doubled() {
    std::vector<std::pair<std::string, std::string>> out;
    while (doubled_.step()) out.emplace_back(doubled_.text(0), doubled_.text(1));
    return out;
  }
  void move(long long id, const std::string& folder) { move_.bind(folder).bind(id).run(); }
  void forget(long long id) { forget_.bind(id).run(); }

  /// @param files null for a scan without a result
  void add(const Entry& entry, const ResultFiles* files) {
    const Scan& scan = *entry.scan;
    Place place = entry.place;
    if (place.date.empty() && files) place.date = files->run.info.time.substr(0, 10);
    scan_.bind(entry.folder).bind(entry.content).bind(scan.status).bind(scan.message).bind(scan.input);
    scan_.bind(place.row).bind(place.date);
    if (files) {
      const io::RunFile& run = files->run;
      scan_.bind(run.info.time).bind(versions_.id_of(run.info.version));
      scan_.bind(parameters_.id_of(run.info.parameters_json, run.info.preset));
      scan_.bind(run.info.scene).bind(run.info.planner).bind(run.info.noise).bind(std::to_string(run.info.seed));
      scan_.bind(files->fruits.size()).bind(run.views).bind(run.stop_reason);
      scan_.bind(run.merged).bind(run.filtered).bind(run.labelled).bind(run.seconds.total);
    } else {
      for (int i = 0; i < 14; ++i) scan_.bind_null();
    }
    scan_.run();
    if (!files) return;
    const long long id = connection_.last_id();
    for (const Fruit& f : files->fruits) add(id, f);
    for (std::size_t v = 0; v < files->views.size(); ++v) add(id, v, files->views[v]);
  }

 private:
  void add(long long scan, const Fruit& f) {
    const Eigen::Vector3d& at = f.position();
    fruit_.bind(scan).bind(f.id).bind(f.truss).bind(f.points).bind(f.found_by);
    fruit_.bind(at.x()).bind(at.y()).bind(at.z());
    if (f.body) {
      const Body& b = *f.body;
      fruit_.bind(2.0 * b.radii.mean()).bind(b.radii[0]).bind(b.radii[1]).bind(b.radii[2]);
      fruit_.bind(b.volume).bind(b.volume_error).bind(b.mass).bind(b.mass_error);
      fruit_.bind(b.completeness).bind(b.confidence);
    } else {
      for (int i = 0; i < 10; ++i) fruit_.bind_null();
    }
    if (f.ripeness)
      fruit_.bind(to_string(f.ripeness->grade)).bind(f.ripeness->probability).bind(f.ripeness->ripe_share);
    else
      fruit_.bind_null().bind_null().bind_null();
    if (f.picking)
      fruit_.bind(f.picking->order).bind(f.picking->reachable ? 1 : 0).bind(to_string(f.picking->reason));
    else
      fruit_.bind_null().bind_null().bind_null();
    fruit_.run();
  }

  void add(long long scan, std::size_t number, const View& view) {
    view_.bind(scan).bind(number);
    const Eigen::Vector3d at = view.world_T_optical.translation(), along = view.world_T_optical.linear().col(2);
    for (const Eigen::Vector3d& v : {at, along})
      for (int i = 0; i < 3; ++i) view_.bind(v[i]);
    view_.bind(view.points_in).bind(view.points_new).bind(view.plan_seconds).run();
  }

  const Connection& connection_;
  Texts versions_, parameters_;
  Statement known_, same_, doubled_, move_, forget_, scan_, fruit_, view_;
};

/// Where a database is, and which folders its relative names mean.
class Home {
 public:
  explicit Home(const std::string& database) {
    std::error_code error;
    path_ = fs::absolute(fs::path(database), error).parent_path().lexically_normal();
  }
  /// What a folder is called in the database.
  std::string name_of(const fs::path& path) const {
    std::error_code error;
    fs::path folder = fs::absolute(path, error).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();  // "scans/1/" is "scans/1"
    return folder.lexically_relative(path_).string();
  }
  /// Whether the folder of a scan is there; where there is no result, that of its list.
  bool has(const Known& scan) const {
    std::error_code error;
    const fs::path folder = path_ / scan.folder;
    return fs::exists(scan.has_result ? folder : folder.parent_path(), error);
  }

 private:
  fs::path path_;
};

/// The entry of a scan.
Entry entry_of(const Scan& scan, const Home& home, const PlaceRules& rules) {
  Entry out{&scan, home.name_of(scan.folder), {}, ""};
  out.place = rules.of(scan.input.empty() ? out.folder : scan.input);
  io::Fingerprint print;  // other rules for rows and dates change the scan, too
  print.add(scan.content + "\n" + out.place.row + "\n" + out.place.date);
  out.content = print.text();
  return out;
}

/// The id of the same scan that is there with a folder that is gone; 0 if there is none.
long long moved_id(const Entry& entry, const Home& home, Writer& writer) {
  for (const Known& known : writer.same(entry.content, entry.scan->input))
    if (!home.has(known)) return known.id;
  return 0;
}

/// Remove scans that are there twice and whose folder is gone, and count the others.
void tell_doubled(const Home& home, Writer& writer, Added& out) {
  for (const auto& [content, input] : writer.doubled()) {
    std::vector<Known> gone, there;
    for (const Known& known : writer.same(content, input)) (home.has(known) ? there : gone).push_back(known);
    if (there.empty()) continue;
    for (const Known& known : gone) writer.forget(known.id), ++out.removed;
    out.twice += there.size() - 1;
    if (there.size() > 1) out.example = there[0].folder + " and " + there[1].folder;
  }
}

}  // namespace

Added add_scans(const std::string& database, const std::vector<Scan>& scans, const std::vector<Scan>& left_out,
                const PlaceRules& rules, int threads) {
  const Connection connection(database, Connection::Mode::write);
  prepare(connection);
  Writer writer(connection);
  Added out;
  const Home home(database);
  std::vector<Entry> entries;
  for (const Scan& scan : scans) {
    entries.push_back(entry_of(scan, home, rules));
    out.places.push_back(entries.back().place);
  }
  std::set<std::string> listed;                          // folders, which may be named twice
  std::vector<std::pair<const Entry*, long long>> open;  // scans that are new or changed, with their id, 0 of new ones
  for (const Entry& e : entries) {
    if (!listed.insert(e.folder).second) continue;
    const std::string& status = e.scan->status;
    if (status != "ok") ++(status == "open" ? out.open : out.failed);
    const auto [id, content] = writer.find(e.folder);
    if (id > 0 && content == e.content)
      out.unchanged += status == "ok";
    else if (const long long there = id > 0 ? 0 : moved_id(e, home, writer); there > 0)
      writer.move(there, e.folder), out.moved += status == "ok";
    else
      open.emplace_back(&e, id);
  }
  for (const Scan& scan : left_out) {
    const Entry entry = entry_of(scan, home, rules);
    long long id = writer.find(entry.folder).first;
    if (id == 0) id = moved_id(entry, home, writer);
    if (id > 0) writer.forget(id), ++out.removed;
  }
  constexpr std::size_t kBatch = 1024;  // so many results are in memory at a time
  for (std::size_t from = 0; from < open.size(); from += kBatch) {
    std::vector<std::optional<ResultFiles>> files(std::min(kBatch, open.size() - from));
    std::vector<std::string> faults(files.size());
    parallel_for(
        files.size(), threads,
        [&](std::size_t k) {
          const Scan& scan = *open[from + k].first->scan;
          if (scan.status != "ok") return;
          try {
            files[k] = read_result(scan.folder);
          } catch (const FileError& e) {
            faults[k] = e.what();
          }
        },
        4);
    for (std::size_t k = 0; k < files.size(); ++k) {
      if (!faults[k].empty()) {
        out.unread.push_back(faults[k]);
        continue;
      }
      const auto [entry, id] = open[from + k];
      if (id > 0) writer.forget(id);
      if (entry->scan->status == "ok") ++(id > 0 ? out.changed : out.added);
      writer.add(*entry, files[k] ? &*files[k] : nullptr);
    }
  }
  tell_doubled(home, writer, out);
  connection.run("COMMIT");
  return out;
}

}  // namespace agrisee::season
