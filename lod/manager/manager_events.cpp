#include "lod/manager/manager_impl.h"

namespace lodestone {

void Manager::set_events(const EventSettings& settings) { impl_->events.set(checked(settings)); }
void Manager::set_events(BodyId body, bool events) {
  impl_->events.ask(impl_->index_of(body), events);
  impl_->recorder.note(Call::set_body_events, body, events);
}
std::span<const ContactEvent> Manager::contact_events() const { return impl_->events.events(); }

}  // namespace lodestone
