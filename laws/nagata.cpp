/// Compiles the nagata law into all its forms.
#include "laws/nagata.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Nagata<double>&);
