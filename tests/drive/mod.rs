//! The drives, tested through their pins.

#[cfg(test)]
mod control_loop;
#[cfg(test)]
mod enabled_drive;
#[cfg(test)]
mod latches;
#[cfg(test)]
mod loop_settings;
#[cfg(test)]
mod position_command;
mod pwm_encoder;
#[cfg(test)]
mod quadrature;
#[cfg(test)]
mod rig;
#[cfg(test)]
mod step_dir;
