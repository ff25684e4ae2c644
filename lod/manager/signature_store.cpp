#include "lod/manager/signature_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "reference/error.h"
#include "signature/signature_file.h"
#include "signature/signature_source.h"

namespace lodestone {
namespace {

// A game goes on meanwhile.
int half_of_the_cores() { return std::max(1, int(std::thread::hardware_concurrency()) / 2); }

}  // namespace

void SignatureStore::Warnings::add(const std::string& text) {
  const std::lock_guard lock(mutex_);
  texts_.push_back(text);
}

std::vector<std::string> SignatureStore::Warnings::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(texts_, {});
}

void SignatureStore::tell_warnings() const {
  for (const std::string& text : warnings_->take())
    if (log_) log_(LogLevel::warning, text);
}

// Each signature is measured by one thread, whose priority is the lowest: with more, they would be oneTBB's,
// which the game's own loops may wait for.
std::unique_ptr<BackgroundSignatures> SignatureStore::make_background(
    const SignatureFunction& source, const std::shared_ptr<Warnings>& warnings) {
  // A caller's source may not bear two threads at a time.
  return std::make_unique<BackgroundSignatures>(
      source ? 1 : half_of_the_cores(),
      [source, warnings](const Shape& shape, const ContactLaw& law, std::stop_token stop) {
        if (source) return source(shape, law);
        SignatureSourceSettings settings;
        settings.threads = 1;
        settings.warn = [warnings](const std::string& text) { warnings->add(text); };
        settings.stop = std::move(stop);
        return find_or_measure_signature(shape, law, settings).signature;
      });
}

SignatureStore::SignatureStore(SignatureFunction source, SignatureTiming timing)
    : source_(std::move(source)),
      in_background_(timing == SignatureTiming::in_background ||
                     (timing == SignatureTiming::automatic && !source_)) {}

bool SignatureStore::ready(const Shape& shape, const ContactLaw& law) {
  if (!in_background_) return true;
  Entry* entry = find_entry(shape, law);
  if (!entry) {
    if (!background_) background_ = make_background(source_, warnings_);
    entries_.push_back({shape.content_hash, law, nullptr, background_->request(shape, law)});
    entry = &entries_.back();
  }
  if (!entry->pending.valid()) return true;
  tell_warnings();
  if (entry->pending.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  take(shape, *entry);
  return true;
}

std::shared_ptr<const Signature> SignatureStore::find(const Shape& shape, const ContactLaw& law) {
  if (Entry* entry = find_entry(shape, law))
    return entry->pending.valid() ? take(shape, *entry) : entry->signature;
  entries_.push_back({shape.content_hash,
                      law,
                      logged(shape,
                             [&] {
                               if (source_) return source_(shape, law);
                               SignatureSourceSettings settings;
                               settings.warn = [&](const std::string& text) { warnings_->add(text); };
                               return find_or_measure_signature(shape, law, settings).signature;
                             }),
                      {}});
  if (entries_.back().signature) ++loaded_;
  return entries_.back().signature;
}

template <class Get>
std::shared_ptr<const Signature> SignatureStore::logged(const Shape& shape, const Get& get) const {
  try {
    std::shared_ptr<const Signature> signature = get();
    tell_warnings();
    if (signature) check_measured_for(*signature, shape, "signature of shape " + shape.name);
    if (log_ && signature) log_(LogLevel::info, fmt::format("the signature of {} is there", shape.name));
    return signature;
  } catch (const InputError& error) {
    if (log_)
      log_(LogLevel::error, fmt::format("the signature of {} cannot be had: {}", shape.name, error.what()));
    throw;
  }
}

const ContactLaw& SignatureStore::law_of(const Signature& signature) const {
  const auto entry =
      std::ranges::find_if(entries_, [&](const Entry& e) { return e.signature.get() == &signature; });
  check_that(entry != entries_.end(), "what bodies move by was found here");
  return entry->law;
}

const RungErrors& SignatureStore::errors(const Shape& shape, const ContactLaw& law) const {
  static const RungErrors kAverages;
  const Entry* entry = find_entry(shape, law);
  return entry && entry->signature ? entry->signature->rung_errors : kAverages;
}

SignatureStore::Entry* SignatureStore::find_entry(const Shape& shape, const ContactLaw& law) {
  const auto entry = std::ranges::find_if(
      entries_, [&](const Entry& e) { return e.shape_hash == shape.content_hash && e.law == law; });
  return entry == entries_.end() ? nullptr : &*entry;
}

// Waits where it must. What the thread could not have is thrown here, each time.
std::shared_ptr<const Signature> SignatureStore::take(const Shape& shape, Entry& entry) {
  entry.signature = logged(shape, [&] { return entry.pending.get(); });
  entry.pending = {};
  if (entry.signature) ++loaded_;
  return entry.signature;
}

}  // namespace lodestone
