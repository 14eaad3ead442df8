// SPDX-License-Identifier: BSD-3-Clause
#include "season/sqlite.hpp"

#include <agrisee/core/error.hpp>

#include <filesystem>
#include <sqlite3.h>

namespace agrisee::season {

void Connection::Closer::operator()(sqlite3* database) const { sqlite3_close(database); }

Connection::Connection(const std::string& path, Mode mode) : path_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw FileError(path + ": is a folder; name the file of a database, as `agrisee merge --db` writes it");
  sqlite3* opened = nullptr;
  const int flags = mode == Mode::write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  const int code = sqlite3_open_v2(path.c_str(), &opened, flags, nullptr);
  database_.reset(opened);
  if (code != SQLITE_OK) fail();
  sqlite3_busy_timeout(opened, 60000);  // ms; another process may be writing
}

void Connection::run(const char* sql) const {
  if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

long long Connection::integer(const char* sql) const {
  Statement question(*this, sql);
  return question.step() ? question.integer(0) : 0;
}

long long Connection::last_id() const { return sqlite3_last_insert_rowid(database_.get()); }

void Connection::fail() const { throw FileError(path_ + ": " + sqlite3_errmsg(database_.get())); }

void Statement::Closer::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(const Connection& connection, const char* sql) : connection_(connection) {
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(connection.get(), sql, -1, &prepared, nullptr) != SQLITE_OK) connection.fail();
  statement_.reset(prepared);
}

Statement& Statement::bind(long long value) {
  if (sqlite3_bind_int64(statement_.get(), ++bound_, value) != SQLITE_OK) connection_.fail();
  return *this;
}

Statement& Statement::bind(double value) {
  if (sqlite3_bind_double(statement_.get(), ++bound_, value) != SQLITE_OK) connection_.fail();
  return *this;
}

Statement& Statement::bind(std::string_view value) {
  if (sqlite3_bind_text(statement_.get(), ++bound_, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT) !=
      SQLITE_OK)
    connection_.fail();
  return *this;
}

Statement& Statement::bind_null() {
  if (sqlite3_bind_null(statement_.get(), ++bound_) != SQLITE_OK) connection_.fail();
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  sqlite3_reset(statement_.get());
  bound_ = 0;
  if (code != SQLITE_DONE) connection_.fail();
  return false;
}

void Statement::reset() {
  sqlite3_reset(statement_.get());
  bound_ = 0;
}

long long Statement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
double Statement::number(int column) const { return sqlite3_column_double(statement_.get(), column); }
bool Statement::is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }
std::string Statement::text(int column) const {
  const unsigned char* const text = sqlite3_column_text(statement_.get(), column);
  return text ? std::string(reinterpret_cast<const char*>(text),
                            static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)))
              : std::string();
}

}  // namespace agrisee::season
