var searchData=
[
  ['nan_5fframe_0',['nan_frame',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33a2cd00c16e35205ca830cf5066c4c68bc',1,'agrisee::study']]],
  ['no_5fbody_1',['no_body',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3da2e9e3db6dd8a357d7e8e74d4f36e457e',1,'agrisee']]],
  ['no_5ffrontier_2',['no_frontier',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadba47614baa41cb5fb8421e38f7433df71f',1,'agrisee']]],
  ['no_5freachable_5fview_3',['no_reachable_view',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadbadce1d1662e747176b1e4559798409a2f',1,'agrisee']]],
  ['noisy_5fpose_4',['noisy_pose',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33a4652fbe6d72bd9b1436dc40c733d5442',1,'agrisee::study']]],
  ['none_5',['none',['../structagrisee_1_1sensor_1_1NoiseModel.html#a41630752e5b192922efedee6a66b28a5a334c4a4c42fdb79d7ebc3e73b517e6f8',1,'agrisee::sensor::NoiseModel']]],
  ['not_5fstopped_6',['not_stopped',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadba0665ad15829cca2ff1c1e3bd81cdd01b',1,'agrisee']]],
  ['not_5ftested_7',['not_tested',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3da9f17cacd97c81c051d8ed5e063705ddb',1,'agrisee']]],
  ['nothing_5fseen_8',['nothing_seen',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadba7a152d0900023f5da7e3f20d134764c5',1,'agrisee']]],
  ['now_9',['now',['../files_8hpp.html#a8d23f3926520b3e981da84241a802c10a97bc592b27a9ada2d9a4bb418ed0ebed',1,'agrisee::io']]]
];
