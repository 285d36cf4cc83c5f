% SPDX-License-Identifier: MIT
function type = type_with(module)
%TYPE_WITH A robot's type that has a module of this kind, for messages.
  if strcmp(module, 'support')
    type = 'transporter';
  else
    type = 'minibot';
  end
end
