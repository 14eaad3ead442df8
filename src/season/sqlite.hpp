// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An SQLite database and its statements as C++ objects. All functions throw FileError("<path>: ...") where SQLite
/// reports an error.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace agrisee::season {

class Connection;

/// A statement that is prepared once and run many times.
class Statement {
 public:
  Statement(const Connection& connection, const char* sql);

  /// Bind the next parameter; the first call after run() binds the first one.
  Statement& bind(long long value);
  Statement& bind(int value) { return bind(static_cast<long long>(value)); }
  Statement& bind(std::size_t value) { return bind(static_cast<long long>(value)); }
  Statement& bind(double value);
  Statement& bind(std::string_view value);
  Statement& bind(const std::string& value) { return bind(std::string_view(value)); }
  Statement& bind(const char* value) { return bind(std::string_view(value)); }
  Statement& bind_null();
  template <typename T>
  Statement& bind(const std::optional<T>& value) {
    return value ? bind(*value) : bind_null();
  }

  /// Go to the next row of the answer. @return false at the end; the parameters may then be bound again
  bool step();
  /// Run to the end.
  void run() {
    while (step()) {
    }
  }
  /// Forget the rest of the answer; the parameters may then be bound again.
  void reset();
  /// A column of the present row, from 0.
  long long integer(int column) const;
  double number(int column) const;
  std::string text(int column) const;
  bool is_null(int column) const;

 private:
  struct Closer {
    void operator()(sqlite3_stmt* statement) const;
  };
  const Connection& connection_;
  std::unique_ptr<sqlite3_stmt, Closer> statement_;
  int bound_ = 0;
};

/// An open database file.
class Connection {
 public:
  enum class Mode { read, write };
  /// @param mode `write` creates the file if it is missing
  /// @throws FileError if it cannot be opened, such as a folder
  Connection(const std::string& path, Mode mode);

  /// Run statements that have no answer.
  void run(const char* sql) const;
  /// The number that a question has for an answer; 0 if it has none.
  long long integer(const char* sql) const;
  /// The id of the row that was inserted last.
  long long last_id() const;
  const std::string& path() const { return path_; }
  sqlite3* get() const { return database_.get(); }
  [[noreturn]] void fail() const;

 private:
  struct Closer {
    void operator()(sqlite3* database) const;
  };
  std::string path_;
  std::unique_ptr<sqlite3, Closer> database_;
};

}  // namespace agrisee::season
