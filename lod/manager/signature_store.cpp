#include "lod/manager/signature_store.h"

#include <algorithm>
#include <chrono>

#include "signature/signature_source.h"

namespace lodestone {
namespace {

// A game goes on meanwhile.
int half_of_the_cores() { return std::max(1, int(std::thread::hardware_concurrency()) / 2); }

std::unique_ptr<BackgroundSignatures> make_background(const SignatureFunction& source) {
  return std::make_unique<BackgroundSignatures>([source](const Shape& shape, const ContactLaw& law, std::stop_token stop) {
    if (source) return source(shape, law);
    SignatureSourceSettings settings;
    settings.threads = half_of_the_cores();
    settings.stop = std::move(stop);
    return find_or_measure_signature(shape, law, settings).signature;
  });
}

}  // namespace

SignatureStore::SignatureStore(SignatureFunction source, SignatureTiming timing)
    : source_(std::move(source)),
      in_background_(timing == SignatureTiming::in_background || (timing == SignatureTiming::automatic && !source_)) {}

bool SignatureStore::ready(const Shape& shape, const ContactLaw& law) {
  if (!in_background_) return true;
  Entry* entry = find_entry(shape, law);
  if (!entry) {
    if (!background_) background_ = make_background(source_);
    entries_.push_back({shape.content_hash, law, nullptr, background_->request(shape, law)});
    entry = &entries_.back();
  }
  if (!entry->pending.valid()) return true;
  if (entry->pending.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  take(*entry);
  return true;
}

std::shared_ptr<const Signature> SignatureStore::find(const Shape& shape, const ContactLaw& law) {
  if (Entry* entry = find_entry(shape, law)) return entry->pending.valid() ? take(*entry) : entry->signature;
  entries_.push_back({shape.content_hash, law, source_ ? source_(shape, law) : find_or_measure_signature(shape, law).signature, {}});
  if (entries_.back().signature) ++loaded_;
  return entries_.back().signature;
}

SignatureStore::Entry* SignatureStore::find_entry(const Shape& shape, const ContactLaw& law) {
  const auto entry = std::ranges::find_if(entries_, [&](const Entry& e) { return e.shape_hash == shape.content_hash && e.law == law; });
  return entry == entries_.end() ? nullptr : &*entry;
}

// Waits where it must. What the thread could not have is thrown here, each time.
std::shared_ptr<const Signature> SignatureStore::take(Entry& entry) {
  entry.signature = entry.pending.get();
  entry.pending = {};
  if (entry.signature) ++loaded_;
  return entry.signature;
}

}  // namespace lodestone
