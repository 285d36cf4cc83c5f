% SPDX-License-Identifier: MIT
function image = image_value(params, kind)
%IMAGE_VALUE Decodes a picture from the params of a reply to get_image: width, height, size, then the bytes, four per param.
%   kind: 0 colour (height x width x 3 uint8), 1 JPEG (a row of uint8), 2 depth (single), 3 segmentation (uint16).
  if numel(params) < 3
    coopdyn.internal.fail(7, 'a reply of the daemon has too few values');
  end
  head = double(params(1:3));
  width = head(1);
  height = head(2);
  bytes = typecast(int32(params(4:end)), 'uint8');
  per_pixel = [3 0 4 2];
  if head(3) > numel(bytes) || (kind ~= 1 && head(3) ~= per_pixel(kind + 1) * width * height)
    coopdyn.internal.fail(7, 'a picture of the daemon has a wrong number of bytes');
  end
  bytes = bytes(1:head(3));
  switch kind
    case 0
      image = permute(reshape(bytes, 3, width, height), [3 2 1]);
    case 1
      image = bytes;
    case 2
      image = reshape(typecast(bytes, 'single'), width, height).';
    otherwise
      image = reshape(typecast(bytes, 'uint16'), width, height).';
  end
end
