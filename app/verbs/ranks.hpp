/// Several processes that compute one plane: rank 0 hands groups of its parts out and gets points back.
#pragma once
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "analysis/planes/parts.hpp"
#include "app/verbs/mail.hpp"
#include "app/verbs/point_records.hpp"

namespace rosin::app::verbs {

/// Rank 0 computes as well. Its main thread answers letters, so that MPI is used by one thread of each process:
///
/// | letter      | from → to | text                                                          |
/// |-------------|-----------|---------------------------------------------------------------|
/// | ask         | r → 0     | checksum of all that determines the plane, and the machine    |
/// | group       | 0 → r     | number of the group, its parts; no parts: nothing is left     |
/// | report      | r → 0     | what came of a group                                          |
/// | failure     | r → 0     | why this process cannot go on                                 |
/// | end         | 0 → r     | whatever was asked or is computed, it is the end              |
/// | farewell    | r → 0     | the last letter of this process                               |
class Ranks : public analysis::planes::Crew {
 public:
  explicit Ranks(std::unique_ptr<Mail>);
  /// Parts from the others, whatever was going on.
  ~Ranks() override;
  Ranks(const Ranks&) = delete;

  bool leads() const override { return mail_->rank() == 0; }
  int processes() const override { return mail_->size(); }
  /// From here on the processes compute a plane. `key`: everything that determines it; all must have the same.
  void begin(const std::string& key, RecordForm);
  void work(analysis::planes::Queue& whole, int threads,
            const std::function<void(analysis::planes::Queue&)>& compute) override;
  /// Of a process that does not lead: why it ends, which rank 0 will say.
  void fail(const std::string& why);
  /// Ends the common work: the others end, and this process is alone from here on.
  void part();

 private:
  class Remote;
  void serve(analysis::planes::Queue&, const std::atomic<bool>& handed_out);
  /// Where it leads: does what a letter asks.
  void answer(const Letter&, analysis::planes::Queue*);
  /// Elsewhere: takes in what has arrived. \throws Stopped where it is the end
  void relay(Remote&);
  /// Takes reports over until all others have said farewell. \returns false if some do not.
  bool end_others(analysis::planes::Queue*);

  std::unique_ptr<Mail> mail_;
  std::uint64_t key_ = 0;
  std::optional<RecordForm> form_;
  std::set<int> gone_;                  ///< the ranks that have said farewell
  std::map<std::size_t, int> at_work_;  ///< the groups that others have, and who
  bool ended_ = false, parted_ = false;
};

}  // namespace rosin::app::verbs
