#include "contact/given/search.h"

#include <ed/given/contact.h>
#include <ed/shape.h>

namespace ed {
ContactResult time_of_contact(const BodyShape& a, const GivenMotion& motion_a, const BodyShape& b,
                              const GivenMotion& motion_b, double t_min, double t_max,
                              const GivenContactOptions& options) {
  internal::check_given("time_of_contact", options, t_min, t_max);
  return internal::given_contact(internal::pair_of(a, b), motion_a, motion_b, {}, t_min, t_max, options);
}

}  // namespace ed
